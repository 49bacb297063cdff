"""The dual-paraboloid map: all directions as two unit discs, one for z ≥ 0, one for z < 0.

Each disc shows a hemisphere of directions as a paraboloid mirror reflects it. The map needs
divisions but no angles, and the density of directions varies by a factor of 4 over a disc. The
functions use arithmetic alone, so they take NumPy's and Dr.Jit's arrays.

[Heidrich & Seidel 1998], [Ergun 2015, chapter 7]
"""

from brdfkit.core.array_types import JitFloat


def to_disc(x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, JitFloat]:
    """Return the point (s, t) of a unit direction on the disc of its hemisphere, z ≥ 0 or z < 0.

    >>> to_disc(0.6, 0.0, -0.8)
    (0.3333333333333333, 0.0)
    """
    scale = 1 / (1 + abs(z))
    return x * scale, y * scale


def from_disc(s: JitFloat, t: JitFloat, sign: JitFloat) -> tuple[JitFloat, JitFloat, JitFloat]:
    """Return the direction (x, y, z) at (s, t) of the disc for z ≥ 0 (`sign` = 1) or z < 0 (-1).

    >>> from_disc(0.0, 0.0, -1)
    (0.0, 0.0, -1.0)
    """
    q = s * s + t * t
    return 2 * s / (1 + q), 2 * t / (1 + q), sign * (1 - q) / (1 + q)


def solid_angle_per_area(z: JitFloat) -> JitFloat:
    """Return the solid angle [sr] per area of a disc, (1 + |z|)², at a direction (x, y, z).

    >>> solid_angle_per_area(1.0)
    4.0
    """
    return (1 + abs(z)) ** 2
