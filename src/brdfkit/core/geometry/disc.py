"""Maps the unit square to the unit disc so that areas stay in proportion [Shirley & Chiu 1997].

Points (x, y) of the disc are directions (x, y, z): equal areas have equal projected solid angles.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray


def square_to_disc(square: FloatArray) -> FloatArray:
    """Map points (n, 2) of the unit square to the unit disc.

    >>> square_to_disc(np.array([[0.5, 0.5], [1.0, 0.5]]))
    array([[0., 0.],
           [1., 0.]])
    """
    a, b = 2 * square.T - 1
    wide = np.abs(a) >= np.abs(b)
    radius, other = np.where(wide, (a, b), (b, a))
    along = np.divide(other, radius, out=np.zeros_like(radius), where=radius != 0) * np.pi / 4
    phi = np.where(wide, along, np.pi / 2 - along)
    return np.stack([radius * np.cos(phi), radius * np.sin(phi)], axis=1)


def disc_to_square(disc: FloatArray) -> FloatArray:
    """Map points (n, 2) of the unit disc to the unit square, the inverse of `square_to_disc`."""
    radius, phi = np.hypot(*disc.T), np.arctan2(disc[:, 1], disc[:, 0])
    quarter = np.round(phi / (np.pi / 2))
    along = (phi - quarter * np.pi / 2) * radius * 4 / np.pi
    turn = quarter.astype(int) % 4
    a = np.choose(turn, [radius, -along, -radius, along])
    b = np.choose(turn, [along, radius, -along, -radius])
    return (np.stack([a, b], axis=1) + 1) / 2
