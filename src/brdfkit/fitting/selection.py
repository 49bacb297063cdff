"""Which samples of a measured material a fit, and its errors, are about."""

import math
from numbers import Real

from brdfkit.errors import BrdfkitError
from brdfkit.materials import require_measured


def selected(data, max_angle):
    """The valid `Samples` with both angles below `max_angle` [degrees].

    Spectral data comes as linear sRGB. Raises `BrdfkitError` where `data` was not measured, the
    angle is not above 0° and at most 90°, or no sample is left.
    """
    require_measured(data)
    if not isinstance(max_angle, Real) or not 0 < max_angle <= 90:
        raise BrdfkitError(
            f"max_angle = {max_angle!r} should be an angle above 0° and at most 90°."
        )
    data = data.rgb
    samples = data.samples
    rows = within(samples, max_angle)
    if not rows.any():
        raise BrdfkitError(
            f"{data.name}: no valid sample has both angles below {max_angle:g}°; "
            "give a larger max_angle."
        )
    return samples.at(rows)


def within(samples, max_angle):
    """Which of the `Samples` are valid, with both angles below `max_angle` [degrees]."""
    cos_min = math.cos(math.radians(max_angle)) * (1 + 1e-12)
    return samples.valid & (samples.wi[:, 2] > cos_min) & (samples.wo[:, 2] > cos_min)
