"""Angles of a user's own, in degrees or radians: checked, and converted to radians."""

import numpy as np

from brdfkit.core.errors import BrdfkitError

# The words for the units. The last: ° in a file of another encoding than UTF-8
DEGREES = ("degrees", "degree", "deg", "°", "\ufffd")
RADIANS = ("radians", "radian", "rad")
LARGEST = {"theta": np.pi / 2, "phi": 2 * np.pi, "delta": 2 * np.pi}  # rad, of either sign
TOLERANCE = 1e-3  # rad: files round 90° to 1.5708


def require_unit(unit):
    """Raise `BrdfkitError` unless the argument `unit` is a word for degrees or radians, or None."""
    if unit not in (None, *DEGREES, *RADIANS):
        raise BrdfkitError(f"unit = {unit!r} should be 'degrees' or 'radians'.")


def to_radians(angles, units, origin):
    """The `angles`, name → numbers (n,), in radians; `units`: name → one of the words, or None.

    Angles without a unit are degrees, unless all thetas are so small that they might be radians:
    then it has to be said. Raises `BrdfkitError` for this, for an angle that is not finite, for a
    theta beyond 90° and an azimuth beyond 360°, of either sign.
    """
    for name, given in angles.items():
        for row in np.flatnonzero(~np.isfinite(given))[:1]:
            raise origin.error(
                f"{name} is {given[row]:g} in {origin.row(row)}; give a number or leave the row out"
            )
    _require_units([name for name in angles if units[name] is None], angles, origin)
    return {name: _convert(name, angles[name], units[name], origin) for name in angles}


def _require_units(names, angles, origin):
    """Raise `BrdfkitError` where the angles of these `names`, without a unit, might be radians."""
    largest = {name: np.abs(angles[name]).max(initial=0) for name in names}
    thetas = {name: angle for name, angle in largest.items() if name.startswith("theta")}
    # azimuths in degrees do not tell the unit of the thetas, which may be of another program
    largest = thetas if any(thetas.values()) else largest
    small = all(angle <= _limit(name) for name, angle in largest.items())
    if small and any(largest.values()):
        raise origin.error(
            f"no {'theta' if largest is thetas else 'angle'} is above {max(largest.values()):.4g}, "
            f"so that they might be degrees or radians; {origin.how_to_say_units}"
        )


def _convert(name, given, unit, origin):
    """The angles `given` in radians, within their limits."""
    in_radians = unit in RADIANS
    angles = given if in_radians else np.radians(given)
    for row in np.flatnonzero(np.abs(angles) > _limit(name))[:1]:
        said = f"{name} is {given[row]:g}{' rad' if in_radians else '°'} in {origin.row(row)}"
        if in_radians:
            raise origin.error(f"{said}, which is too large; {origin.how_to_say_units}")
        if name.startswith("theta"):
            raise origin.error(
                f"{said}, which is below the horizon: brdfkit holds reflection, and theta is the "
                "angle to the normal; leave the row out"
            )
        raise origin.error(f"{said}, more than a turn; mend it or leave the row out")
    return angles


def _limit(name):
    """The largest absolute value of the angle of this name [rad]."""
    return LARGEST[name.partition("_")[0]] + TOLERANCE
