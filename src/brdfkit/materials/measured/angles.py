"""Converts angles that a user gives in degrees or radians to radians, and checks their ranges."""

from collections.abc import Iterable, Mapping

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.validation import Origin

# Words for the units. "\ufffd" is what remains of ° in a file that is not encoded in UTF-8
DEGREES = ("degrees", "degree", "deg", "°", "\ufffd")
RADIANS = ("radians", "radian", "rad")
# Largest absolute values [rad], by the first word of the angle's name
LARGEST_ANGLES = {"theta": np.pi / 2, "phi": 2 * np.pi, "delta": 2 * np.pi}
TOLERANCE = 1e-3  # rad; angles may exceed these limits by this much: files round 90° to 1.5708


def require_known_unit(unit: str | None) -> None:
    """Raise `BrdfkitError` unless `unit` is a word for degrees or radians, or None."""
    if unit not in (None, *DEGREES, *RADIANS):
        raise BrdfkitError(f"unit = {unit!r} should be 'degrees' or 'radians'.")


def to_radians(
    angles: Mapping[str, FloatArray], units: Mapping[str, str | None], origin: Origin
) -> dict[str, FloatArray]:
    """Return the `angles`, arrays (n,) by name, in radians.

    `units` has a word for the unit of each angle, or None. An angle without a unit is in degrees,
    unless all thetas are so small that they might be in radians: this raises `BrdfkitError`, and so
    do angles that are not finite, thetas beyond ±90° and azimuths beyond ±360°.
    """
    for name, numbers in angles.items():
        for row in np.flatnonzero(~np.isfinite(numbers))[:1]:
            raise origin.error(
                f"{name} is {numbers[row]:g} in {origin.locate_row(row)}; give a number or leave "
                "the row out"
            )
    _refuse_ambiguous_units([name for name in angles if units[name] is None], angles, origin)
    return {name: _convert_angle(name, angles[name], units[name], origin) for name in angles}


def _refuse_ambiguous_units(
    names: Iterable[str], angles: Mapping[str, FloatArray], origin: Origin
) -> None:
    """Raise `BrdfkitError` if the angles with these `names` might be in degrees or in radians."""
    largest = {name: np.abs(angles[name]).max(initial=0) for name in names}
    thetas = {name: angle for name, angle in largest.items() if name.startswith("theta")}
    # Large azimuths, surely in degrees, do not prove that the thetas are in degrees, too
    largest = thetas if any(thetas.values()) else largest
    small = all(angle <= _find_angle_limit(name) for name, angle in largest.items())
    if small and any(largest.values()):
        raise origin.error(
            f"no {'theta' if largest is thetas else 'angle'} is above {max(largest.values()):.4g}, "
            f"so that they might be degrees or radians; {origin.unit_advice}"
        )


def _convert_angle(name: str, numbers: FloatArray, unit: str | None, origin: Origin) -> FloatArray:
    """Return one angle's `numbers` (n,) in radians; raise `BrdfkitError` for those out of range."""
    in_radians = unit in RADIANS
    angles = numbers if in_radians else np.radians(numbers)
    for row in np.flatnonzero(np.abs(angles) > _find_angle_limit(name))[:1]:
        what = (
            f"{name} is {numbers[row]:g}{' rad' if in_radians else '°'} in {origin.locate_row(row)}"
        )
        if in_radians:
            raise origin.error(f"{what}, which is too large; {origin.unit_advice}")
        if name.startswith("theta"):
            raise origin.error(
                f"{what}, which is below the horizon, but a BRDF describes reflection alone, and "
                "theta is the angle to the normal; leave the row out"
            )
        raise origin.error(f"{what}, more than a full turn; correct it or leave the row out")
    return angles


def _find_angle_limit(name: str) -> float:
    """Return the largest absolute value [rad] that is accepted for the angle with this name."""
    return LARGEST_ANGLES[name.partition("_")[0]] + TOLERANCE
