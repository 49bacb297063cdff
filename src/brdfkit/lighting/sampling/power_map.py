"""Power per angle of an environment map, which samplers draw points in proportion to.

A map has rows from the polar angle 0 to π, both included, and columns around; a cell lies between
four pixels.
"""

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError


def require_light(name: str, pixels: AnyArray) -> None:
    """Raise `BrdfkitError` unless `pixels` (rows, columns, channels) give light.

    The error begins with `name`.
    """
    if pixels.ndim != 3 or min(pixels.shape[:2]) < 2:
        size = "×".join(map(str, pixels.shape[1::-1]))
        raise BrdfkitError(f"{name} has {size} pixels; give 2×2 or more.")
    if not np.isfinite(pixels).all():
        raise BrdfkitError(f"{name} has values that are not finite; mend them.")
    if pixels.max() <= 0:
        raise BrdfkitError(f"{name} is black all over and lights nothing; give another map.")


def cell_power(brightness: FloatArray) -> FloatArray:
    """Return the power per angle (rows - 1, columns) of the cells between pixels.

    A cell has the mean `brightness` (rows, columns) of its four pixels, so that it is black only
    where the interpolated map is black.
    """
    pairs = brightness + np.roll(brightness, -1, axis=1)
    between = (pairs[:-1] + pairs[1:]) / 4
    theta = np.pi * (np.arange(len(between)) + 0.5) / len(between)
    return between * np.sin(theta)[:, None]


def pixel_power(brightness: FloatArray) -> FloatArray:
    """Return the power per angle (rows, columns) at pixels of `brightness` (rows, columns)."""
    theta = np.linspace(0, np.pi, len(brightness))
    return brightness * np.sin(theta).clip(0)[:, None]


def subtract_mean(brightness: FloatArray) -> FloatArray:
    """Return the `brightness` (rows, columns) above its mean over the sphere, else 0.

    A density made of it serves where surfaces draw directions as well, because their samples take
    care of the uniform part of the light. A uniform map is returned unchanged. [Karlík et al. 2019]
    """
    theta = np.linspace(0, np.pi, len(brightness))
    mean = np.average(brightness.mean(axis=1), weights=np.sin(theta))
    above = (brightness - mean).clip(0)
    return above if above.max() > 1e-6 * mean else brightness
