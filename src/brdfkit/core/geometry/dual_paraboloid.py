"""The dual-paraboloid map: all directions as two unit discs, one for z ≥ 0, one for z < 0.

A direction of either hemisphere is seen in a paraboloid mirror from below or above. There are no
angles in it, only divisions, and the density of directions varies by a factor of 4 over a disc.
Written by arithmetic alone, for NumPy arrays and Dr.Jit's alike.

[Heidrich & Seidel 1998], [Ergun 2015, chapter 7]
"""


def to_disc(x, y, z):
    """The place (s, t) in the unit disc of a unit direction; which disc says the sign of `z`.

    >>> to_disc(0.6, 0.0, -0.8)
    (0.3333333333333333, 0.0)
    """
    scale = 1 / (1 + abs(z))
    return x * scale, y * scale


def from_disc(s, t, sign):
    """The unit direction (x, y, z) at (s, t) of the disc of z ≥ 0 (`sign` = 1) or z < 0 (-1).

    >>> from_disc(0.0, 0.0, -1)
    (0.0, 0.0, -1.0)
    """
    q = s * s + t * t
    return 2 * s / (1 + q), 2 * t / (1 + q), sign * (1 - q) / (1 + q)


def solid_angle(z):
    """Solid angle [sr] per area of the disc at a direction: (1 + |z|)².

    >>> solid_angle(1.0)
    4.0
    """
    return (1 + abs(z)) ** 2
