"""Converts the coordinates of a user's samples, which are given by name, to pairs of directions.

z is along the normal, and phi = 0 along x. A negative theta points to the other side of the normal,
as a turn of phi by 180° does. `wi` points to the light and `wo` to the viewer, so that the mirror
direction is at phi_o - phi_i = 180°.
"""

from collections.abc import Mapping

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles, from_half_difference
from brdfkit.materials.measured.angles import RADIANS, to_radians
from brdfkit.materials.measured.validation import Origin

ANGLES = ("theta_i", "phi_i", "theta_o", "phi_o")
# Each line is a set of coordinates that determines both directions
COORDINATES = (
    ANGLES,
    ("theta_i", "theta_o", "delta_phi"),
    ("theta_h", "phi_h", "theta_d", "phi_d"),
    ("theta_h", "theta_d", "phi_d"),
    ("wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z"),
)
ROUNDING = 1e-3  # rad; azimuths that differ by less count as equal
LENGTH_TOLERANCE = 1e-3  # a unit vector's length may differ by this much from 1


def to_directions(
    coordinates: Mapping[str, FloatArray], units: Mapping[str, str | None], origin: Origin
) -> tuple[FloatArray, FloatArray]:
    """Return the directions wi and wo (n, 3) for `coordinates`, arrays (n,) by name.

    The names are one line of `COORDINATES`. `units` has a word for the unit of each angle, or None.
    Raises `BrdfkitError` for impossible coordinates, and for directions below the horizon. Half and
    difference angles are an exception: directions below the horizon are returned, to be masked.
    """
    if "wi_x" in coordinates:
        return _to_unit_vectors("wi", coordinates, origin), _to_unit_vectors(
            "wo", coordinates, origin
        )
    angles = to_radians(coordinates, units, origin)
    if "theta_h" in angles:
        return from_half_difference(**angles)
    phi_o = angles["phi_o"] if "phi_o" in angles else angles["delta_phi"]
    phi_i = angles.get("phi_i", 0.0)
    return from_angles(angles["theta_i"], phi_i), from_angles(angles["theta_o"], phi_o)


def is_surface_turned(
    coordinates: Mapping[str, FloatArray], units: Mapping[str, str | None]
) -> bool:
    """Return whether the surface was turned about its normal between the samples.

    It was if the azimuth of wi, or of the half vector, varies by more than `ROUNDING`. Directions
    along the normal, which have no azimuth, are ignored, and a negative theta is no turn.
    `coordinates` are arrays (n,) by name, and `units` has a word for each angle's unit, or None.
    """
    if "wi_x" in coordinates:
        x, y = coordinates["wi_x"], coordinates["wi_y"]
    else:
        half = "h" if "theta_h" in coordinates else "i"
        theta, name = coordinates[f"theta_{half}"], f"phi_{half}"
        if name not in coordinates:
            return False
        phi = coordinates[name] if units[name] in RADIANS else np.radians(coordinates[name])
        x, y = (theta != 0) * np.cos(phi), (theta != 0) * np.sin(phi)
    length = np.hypot(x, y)
    if not length.size:
        return False
    first = np.argmax(length)
    cos, sin = x[first], y[first]
    along, across = cos * x + sin * y, cos * y - sin * x
    turned = (np.abs(across) > ROUNDING) | (along < 0)
    return bool(np.any((length > ROUNDING) & turned))


def _to_unit_vectors(
    name: str, coordinates: Mapping[str, FloatArray], origin: Origin
) -> FloatArray:
    """Return the directions (n, 3) with the components `name`_x, _y, _z, checked for errors."""
    vectors = np.stack([coordinates[f"{name}_{axis}"] for axis in "xyz"], axis=1)
    with np.errstate(over="ignore"):
        lengths = np.linalg.norm(vectors, axis=1)
    for row in np.flatnonzero(~(np.abs(lengths - 1) <= LENGTH_TOLERANCE))[:1]:
        raise origin.error(
            f"{name} has the length {lengths[row]:.4g} in {origin.locate_row(row)}, where 1 "
            "belongs; give unit vectors"
        )
    for row in np.flatnonzero(vectors[:, 2] <= 0)[:1]:
        raise origin.error(
            f"{name}_z is {vectors[row, 2]:.4g} in {origin.locate_row(row)}, which is below the "
            "horizon, but a BRDF describes reflection alone; leave the row out"
        )
    return vectors
