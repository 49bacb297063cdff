"""Environment maps as numbers: pixels that give light, their brightness, and power over angles.

A map has rows from the polar angle 0 to π, both included, and columns around; a cell lies between
four pixels.
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError


def require_light(what, pixels):
    """Raise `BrdfkitError`, which begins with `what`, for pixels that give no light."""
    if pixels.ndim != 3 or min(pixels.shape[:2]) < 2:
        size = "×".join(map(str, pixels.shape[1::-1]))
        raise BrdfkitError(f"{what} has {size} pixels; give 2×2 or more.")
    if not np.isfinite(pixels).all():
        raise BrdfkitError(f"{what} has values that are not finite; mend them.")
    if pixels.max() <= 0:
        raise BrdfkitError(f"{what} is black all over and lights nothing; give another map.")


def cell_power(brightness):
    """Power (rows - 1, columns) per angle of the cells of pixels of `brightness` (rows, columns).

    A cell is as bright as the mean of its pixels: it is black only where the interpolated map is.
    """
    pairs = brightness + np.roll(brightness, -1, axis=1)
    between = (pairs[:-1] + pairs[1:]) / 4
    theta = np.pi * (np.arange(len(between)) + 0.5) / len(between)
    return between * np.sin(theta)[:, None]


def pixel_power(brightness):
    """Power (rows, columns) per angle at pixels of `brightness` (rows, columns)."""
    theta = np.linspace(0, np.pi, len(brightness))
    return brightness * np.sin(theta).clip(0)[:, None]


def compensated(brightness):
    """The `brightness` (rows, columns) above its mean over the sphere, for a density of samples.

    Where directions are drawn by surfaces as well, these serve the even part of the light. A map
    that is even all over stays as it is. [Karlík et al. 2019]
    """
    theta = np.linspace(0, np.pi, len(brightness))
    mean = np.average(brightness.mean(axis=1), weights=np.sin(theta))
    above = (brightness - mean).clip(0)
    return above if above.max() > 1e-6 * mean else brightness
