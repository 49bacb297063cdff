"""The power per angle of an environment map, the density with which samplers draw its points.

It is the brightness times the sine of the polar angle. A map's rows reach from the polar angle 0 to
π, both included. A cell is the square between four neighbouring pixels.
"""

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError


def require_lit_map(name: str, pixels: AnyArray) -> None:
    """Raise `BrdfkitError` if a map's `pixels` are black, not finite, or fewer than 2×2.

    Their shape is (rows, columns, channels). The error begins with `name`.
    """
    if pixels.ndim != 3 or min(pixels.shape[:2]) < 2:
        size = "×".join(map(str, pixels.shape[1::-1]))
        raise BrdfkitError(f"{name} has {size} pixels; give 2×2 or more.")
    if not np.isfinite(pixels).all():
        raise BrdfkitError(f"{name} has values that are not finite; mend them.")
    if pixels.max() <= 0:
        raise BrdfkitError(f"{name} is black all over and lights nothing; give another map.")


def cell_power(brightness: FloatArray) -> FloatArray:
    """Return the power per angle (rows - 1, columns) of a map's cells.

    A cell has the mean `brightness` (rows, columns) of the four pixels at its corners, so that it
    is black only where the interpolated map is black.
    """
    pairs = brightness + np.roll(brightness, -1, axis=1)
    between = (pairs[:-1] + pairs[1:]) / 4
    theta = np.pi * (np.arange(len(between)) + 0.5) / len(between)
    return between * np.sin(theta)[:, None]


def pixel_power(brightness: FloatArray) -> FloatArray:
    """Return the power per angle (rows, columns) at a map's pixels, from their `brightness`."""
    theta = np.linspace(0, np.pi, len(brightness))
    return brightness * np.sin(theta).clip(0)[:, None]


def subtract_mean_brightness(brightness: FloatArray) -> FloatArray:
    """Subtract the mean over the sphere from a map's `brightness` (rows, columns), down to 0.

    The result is a density for multiple importance sampling, in which the BSDF's samples find the
    uniform part of the light. A uniform map is returned unchanged. [Karlík et al. 2019]
    """
    theta = np.linspace(0, np.pi, len(brightness))
    mean = np.average(brightness.mean(axis=1), weights=np.sin(theta))
    above = (brightness - mean).clip(0)
    return above if above.max() > 1e-6 * mean else brightness
