"""The coordinates of a user's samples, by name and checked, as pairs of directions.

z is along the normal and phi = 0 along x; a theta below 0 is on the other side of the normal, as
phi + 180°. `wi` points to the light and `wo` to the viewer, so that the mirror direction is at
phi_o - phi_i = 180°.
"""

import numpy as np

from brdfkit.geometry.directions import from_angles, from_half_difference
from brdfkit.measured.angles import to_radians

ANGLES = ("theta_i", "phi_i", "theta_o", "phi_o")
# The coordinates that give both directions: a table has those of one line
COORDINATES = (
    ANGLES,
    ("theta_i", "theta_o", "delta_phi"),
    ("theta_h", "phi_h", "theta_d", "phi_d"),
    ("theta_h", "theta_d", "phi_d"),
    ("wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z"),
)
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


def turns(given):
    """Whether the coordinates `given` turn the surface: whether phi_i, or phi_h, varies."""
    for theta, phi in (("theta_i", "phi_i"), ("theta_h", "phi_h")):
        if phi in given:
            oblique = given[phi][given[theta] != 0]
            return bool(oblique.size and np.ptp(oblique) > 0)
    return False


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
