"""The pictures that are to be reached: read, checked, and weighed pixel by pixel."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brdfkit.colours import from_srgb
from brdfkit.errors import BrdfkitError
from brdfkit.host.picture_file import read_photograph

DARK = 0.02  # of the mean brightness, added to a pixel's: no difference counts without end then
WHITE = 0.99  # the share of numbers that are darker than white
CLIPPED = 1e-3  # the share of numbers that equal the largest: not by chance


@dataclass(frozen=True)
class Target:
    """A picture to reach: `pixels` (height, width, channels), their `weights` (the same shape), 0
    where they are clipped, and the share that is `clipped`."""

    pixels: np.ndarray
    weights: np.ndarray
    clipped: float

    @property
    def size(self):
        """(width, height)."""
        return self.pixels.shape[1], self.pixels.shape[0]


def read_targets(pictures, linearise=False):
    """The `Target`s of one picture or several: arrays (height, width[, channels]) or paths.

    Raises `BrdfkitError` for what is no picture, not finite, or of 8 bits, unless it is to
    `linearise` by sRGB's curve.
    """
    alone = isinstance(pictures, str | Path) or getattr(pictures, "ndim", 4) < 4
    several = [pictures] if alone else list(pictures)
    if not several:
        raise BrdfkitError("there is no picture to reach; give one for each sensor.")
    return [_read(one, f"picture {number}", linearise) for number, one in enumerate(several)]


def _read(picture, name, linearise):
    if isinstance(picture, str | Path):
        picture, name = read_photograph(picture, linearise), str(picture)
    pixels = np.asarray(picture)
    if pixels.dtype == np.uint8:
        if not linearise:
            raise BrdfkitError(
                f"{name}: its numbers have 8 bits, behind a curve for screens; give linear pixels, "
                "as of an OpenEXR file, or say linearise=True, for sRGB's curve."
            )
        pixels = from_srgb(pixels / 255.0)
    if pixels.ndim == 2:
        pixels = pixels[..., None]
    if pixels.ndim != 3 or pixels.shape[2] not in (1, 3, 4) or not pixels.size:
        raise BrdfkitError(
            f"{name}: its shape {pixels.shape} is no picture's; it should be (height, width, 3)."
        )
    pixels = pixels[..., :3].astype(float)
    if not np.isfinite(pixels).all():
        raise BrdfkitError(f"{name}: {_count_bad(pixels)} of its pixels are not finite.")
    if not pixels.max() > 0:
        raise BrdfkitError(f"{name}: it is black; nothing can be learned from it.")
    clipped = _clipped(pixels)
    weights = np.where(clipped, 0, _weights(pixels))
    return Target(pixels, weights, float(clipped.mean()))


def _count_bad(pixels):
    return f"{(~np.isfinite(pixels)).any(axis=2).sum():,}"


def _clipped(pixels):
    """Which numbers are at the end of what a camera could hold."""
    at_end = pixels == pixels.max()
    return at_end if at_end.mean() > CLIPPED and at_end.sum() > 8 else np.zeros_like(at_end)


def _weights(pixels):
    """What the square of a pixel's difference counts, by the slope of sRGB's curve at the pixel, as
    a screen shows it; relative to the pixel where it is brighter than white.

    The curve itself would bias what is rendered with noise; its slope at the picture does not.
    """
    white = np.quantile(pixels, WHITE) or pixels.max()
    x = (_neighbourhood(pixels) + DARK * pixels.mean()) / white
    shown = np.minimum(x, 1)
    slope = np.where(shown <= 0.0031308, 12.92, 1.055 / 2.4 * shown ** (1 / 2.4 - 1))
    return (slope / (white * np.maximum(x, 1))) ** 2


def _neighbourhood(pixels):
    """Means over 5 by 5 pixels: weights that went with a pixel's own noise would mislead."""
    from scipy.ndimage import uniform_filter

    return np.maximum(uniform_filter(pixels, size=(5, 5, 1), mode="nearest"), 0)
