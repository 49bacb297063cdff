"""The coordinates of a user's samples, by name and checked, as pairs of directions.

z is along the normal and phi = 0 along x; a theta below 0 is on the other side of the normal, as
phi + 180°. `wi` points to the light and `wo` to the viewer, so that the mirror direction is at
phi_o - phi_i = 180°.
"""

import numpy as np

from brdfkit.core.geometry.directions import from_angles, from_half_difference
from brdfkit.materials.measured.angles import RADIANS, to_radians

ANGLES = ("theta_i", "phi_i", "theta_o", "phi_o")
# The coordinates that give both directions: a table has those of one line
COORDINATES = (
    ANGLES,
    ("theta_i", "theta_o", "delta_phi"),
    ("theta_h", "phi_h", "theta_d", "phi_d"),
    ("theta_h", "theta_d", "phi_d"),
    ("wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z"),
)
TURN = 1e-3  # rad: directions that differ less are rounded
UNIT_LENGTH = 1e-3  # how far the length of a direction may be from 1


def to_directions(given, units, origin):
    """The directions wi, wo (n, 3) of the coordinates `given`, name → numbers (n,), of one line of
    `COORDINATES`; `units`: name of an angle → a word for its unit, or None.

    Directions of half and difference angles may be below the horizon: the caller masks them.
    Raises `BrdfkitError` for other coordinates below the horizon, and those that are none.
    """
    if "wi_x" in given:
        return _to_vectors("wi", given, origin), _to_vectors("wo", given, origin)
    angles = to_radians(given, units, origin)
    if "theta_h" in angles:
        return from_half_difference(**angles)
    phi_o = angles["phi_o"] if "phi_o" in angles else angles["delta_phi"]
    phi_i = angles.get("phi_i", 0.0)
    return from_angles(angles["theta_i"], phi_i), from_angles(angles["theta_o"], phi_o)


def turns(given, units):
    """Whether the coordinates `given` turn the surface: whether the azimuth of wi, or of the half
    vector, varies by more than `TURN` where it has one.

    A theta below 0 does not turn it: phi is the same. `units`: see `to_directions`.
    """
    if "wi_x" in given:
        x, y = given["wi_x"], given["wi_y"]
    else:
        half = "h" if "theta_h" in given else "i"
        theta, name = given[f"theta_{half}"], f"phi_{half}"
        if name not in given:
            return False
        phi = given[name] if units[name] in RADIANS else np.radians(given[name])
        x, y = (theta != 0) * np.cos(phi), (theta != 0) * np.sin(phi)
    length = np.hypot(x, y)
    if not length.size:
        return False
    first = np.argmax(length)
    cos, sin = x[first], y[first]
    along, across = cos * x + sin * y, cos * y - sin * x
    return bool(np.any((length > TURN) & ((np.abs(across) > TURN) | (along < 0))))


def _to_vectors(name, given, origin):
    """The vectors (n, 3) of this name, which should be unit vectors above the surface."""
    vectors = np.stack([given[f"{name}_{axis}"] for axis in "xyz"], axis=1)
    with np.errstate(over="ignore"):
        lengths = np.linalg.norm(vectors, axis=1)
    for row in np.flatnonzero(~(np.abs(lengths - 1) <= UNIT_LENGTH))[:1]:
        raise origin.error(
            f"{name} has the length {lengths[row]:.4g} in {origin.row(row)}, where 1 belongs; "
            "give unit vectors"
        )
    for row in np.flatnonzero(vectors[:, 2] <= 0)[:1]:
        raise origin.error(
            f"{name}_z is {vectors[row, 2]:.4g} in {origin.row(row)}, which is below the horizon: "
            "brdfkit holds reflection; leave the row out"
        )
    return vectors
