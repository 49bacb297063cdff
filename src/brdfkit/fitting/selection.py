"""Which samples of a measured material a fit, and its errors, are about."""

import math

from brdfkit.errors import BrdfkitError


def selected(data, max_angle):
    """The valid `Samples` with both angles below `max_angle` [degrees].

    Spectral data comes as linear sRGB.
    """
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
