"""Angles that a user gives in degrees or radians: checks them and converts them to radians."""

from collections.abc import Iterable, Mapping

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.validation import Origin

# The words for the units. The last: ° in a file of another encoding than UTF-8
DEGREES = ("degrees", "degree", "deg", "°", "\ufffd")
RADIANS = ("radians", "radian", "rad")
LARGEST_ANGLES = {"theta": np.pi / 2, "phi": 2 * np.pi, "delta": 2 * np.pi}  # rad, of either sign
TOLERANCE = 1e-3  # rad: files round 90° to 1.5708


def require_unit(unit: str | None) -> None:
    """Raise `BrdfkitError` unless the argument `unit` is a word for degrees or radians, or None."""
    if unit not in (None, *DEGREES, *RADIANS):
        raise BrdfkitError(f"unit = {unit!r} should be 'degrees' or 'radians'.")


def to_radians(
    angles: Mapping[str, FloatArray], units: Mapping[str, str | None], origin: Origin
) -> dict[str, FloatArray]:
    """Return the `angles`, arrays (n,) by name, in radians.

    `units` has a word for the unit of each angle, or None. Angles without a unit are degrees, but
    the unit must be stated where all thetas are so small that they might be radians. Raises
    `BrdfkitError` where it is not, for an angle that is not finite, for a theta beyond 90° and for
    an azimuth beyond 360°, of either sign.
    """
    for name, numbers in angles.items():
        for row in np.flatnonzero(~np.isfinite(numbers))[:1]:
            raise origin.error(
                f"{name} is {numbers[row]:g} in {origin.row(row)}; give a number or leave the row "
                "out"
            )
    _require_units([name for name in angles if units[name] is None], angles, origin)
    return {name: _convert(name, angles[name], units[name], origin) for name in angles}


def _require_units(names: Iterable[str], angles: Mapping[str, FloatArray], origin: Origin) -> None:
    """Raise `BrdfkitError` where the angles of these `names`, without a unit, might be radians."""
    largest = {name: np.abs(angles[name]).max(initial=0) for name in names}
    thetas = {name: angle for name, angle in largest.items() if name.startswith("theta")}
    # Azimuths in degrees do not prove the unit of the thetas, which may come from another program
    largest = thetas if any(thetas.values()) else largest
    small = all(angle <= _find_limit(name) for name, angle in largest.items())
    if small and any(largest.values()):
        raise origin.error(
            f"no {'theta' if largest is thetas else 'angle'} is above {max(largest.values()):.4g}, "
            f"so that they might be degrees or radians; {origin.how_to_state_units}"
        )


def _convert(name: str, numbers: FloatArray, unit: str | None, origin: Origin) -> FloatArray:
    """Return the `numbers` of one angle in radians; raise `BrdfkitError` beyond its limit."""
    in_radians = unit in RADIANS
    angles = numbers if in_radians else np.radians(numbers)
    for row in np.flatnonzero(np.abs(angles) > _find_limit(name))[:1]:
        what = f"{name} is {numbers[row]:g}{' rad' if in_radians else '°'} in {origin.row(row)}"
        if in_radians:
            raise origin.error(f"{what}, which is too large; {origin.how_to_state_units}")
        if name.startswith("theta"):
            raise origin.error(
                f"{what}, which is below the horizon: brdfkit holds reflection, and theta is the "
                "angle to the normal; leave the row out"
            )
        raise origin.error(f"{what}, more than a turn; mend it or leave the row out")
    return angles


def _find_limit(name: str) -> float:
    """Return the largest absolute value [rad] of the angle with this name."""
    return LARGEST_ANGLES[name.partition("_")[0]] + TOLERANCE
