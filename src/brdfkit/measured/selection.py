"""Selects the samples of a measured material that fits and comparisons use."""

from numbers import Real

from brdfkit.errors import BrdfkitError
from brdfkit.samples import Samples


def select_samples(data, max_angle):
    """The valid `Samples` of a `Measured` with both angles below `max_angle` [degrees].

    Spectral samples are converted to linear sRGB. Raises `BrdfkitError` for an angle that is not
    above 0° and at most 90°, and where no sample is left.
    """
    require_max_angle(max_angle)
    data = data.rgb
    if data.is_table:
        samples = Samples.of_cells(data.table, max_angle)
    else:
        samples = data.samples.at(data.samples.within(max_angle))
    if not len(samples.wi):
        raise BrdfkitError(
            f"{data.name}: no valid sample has both angles below {max_angle:g}°; "
            "give a larger max_angle."
        )
    return samples


def require_max_angle(max_angle):
    """Raise `BrdfkitError` unless `max_angle` is above 0° and at most 90°."""
    if not isinstance(max_angle, Real) or not 0 < max_angle <= 90:
        raise BrdfkitError(
            f"max_angle = {max_angle!r} should be an angle above 0° and at most 90°."
        )
