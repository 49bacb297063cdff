"""The pictures that are to be reached: read, checked, and weighed pixel by pixel."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brdfkit.core.colours import from_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.scenes.problem.masks import read_masks
from brdfkit.mitsuba_bridge.properties.picture_file import read_photograph

DARK = 0.02  # of the mean brightness, added to a pixel's: no difference counts without end then
WHITE = 0.99  # the share of numbers that are darker than white
CLIPPED = 1e-3  # the share of numbers that equal the largest: not by chance


@dataclass(frozen=True)
class Target:
    """A picture to reach: `pixels` (height, width, channels); their `weights` (the same shape), 0
    where they are masked or clipped; the sum of the mask over the numbers that are not, their
    `count`; the share that is `clipped`; `seen`, which pixels (height, width) are not masked."""

    pixels: np.ndarray
    weights: np.ndarray
    count: float
    clipped: float
    seen: np.ndarray

    @property
    def size(self):
        """(width, height)."""
        return self.pixels.shape[1], self.pixels.shape[0]


def read_targets(pictures, linearise=False, mask=None):
    """The `Target`s of one picture or several: arrays (height, width[, channels]) or paths.

    `mask`: see `read_masks`. Raises `BrdfkitError` for what is no picture, not finite, or of 8
    bits, unless it is to `linearise` by sRGB's curve.
    """
    alone = isinstance(pictures, str | Path) or getattr(pictures, "ndim", 4) < 4
    several = [pictures] if alone else list(pictures)
    if not several:
        raise BrdfkitError("there is no picture to reach; give one for each sensor.")
    masks = read_masks(mask, len(several))
    return [
        _read(one, f"picture {number}", linearise, mask)
        for number, (one, mask) in enumerate(zip(several, masks, strict=True))
    ]


def _read(picture, name, linearise, mask):
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
    mask = np.ones(pixels.shape[:2]) if mask is None else mask
    if mask.shape != pixels.shape[:2]:
        raise BrdfkitError(
            f"{name}: its mask has the shape {mask.shape}, and it {pixels.shape[:2]}: they should "
            "be equal."
        )
    pixels = np.where(mask[..., None] > 0, pixels, 0)
    if not np.isfinite(pixels).all():
        raise BrdfkitError(f"{name}: {_count_bad(pixels)} of its pixels are not finite.")
    if not pixels.max() > 0:
        raise BrdfkitError(f"{name}: it is black; nothing can be learned from it.")
    counts = np.broadcast_to(mask[..., None], pixels.shape)
    clipped = _clipped(pixels, counts > 0)
    counts = np.where(clipped, 0, counts)
    share = clipped.sum() / (pixels.shape[2] * np.count_nonzero(mask))
    return Target(pixels, counts * _weights(pixels, mask > 0), counts.sum(), float(share), mask > 0)


def _count_bad(pixels):
    return f"{(~np.isfinite(pixels)).any(axis=2).sum():,}"


def _clipped(pixels, counts):
    """Which of the numbers that count are at the end of what a camera could hold."""
    at_end = counts & (pixels == pixels.max())
    many = at_end.sum() > max(8, CLIPPED * counts.sum())
    return at_end if many else np.zeros_like(at_end)


def _weights(pixels, seen):
    """What the square of a pixel's difference counts, by the slope of sRGB's curve at the pixel, as
    a screen shows it; relative to the pixel where it is brighter than white. White and means are
    those of the pixels that are `seen` (height, width).

    The curve itself would bias what is rendered with noise; its slope at the picture does not.
    """
    white = white_of(pixels[seen])
    x = (_neighbourhood(pixels, seen) + DARK * pixels[seen].mean()) / white
    shown = np.minimum(x, 1)
    slope = np.where(shown <= 0.0031308, 12.92, 1.055 / 2.4 * shown ** (1 / 2.4 - 1))
    return (slope / (white * np.maximum(x, 1))) ** 2


def white_of(pixels):
    """What is white among the `pixels` that are seen: the largest, where nearly all are black."""
    return np.quantile(pixels, WHITE) or pixels.max()


def _neighbourhood(pixels, seen):
    """Means over those of 5 by 5 pixels that are `seen`, the others 0: weights that went with a
    pixel's own noise would mislead."""
    from scipy.ndimage import uniform_filter

    seen = seen[..., None].astype(float)
    total, share = (uniform_filter(a, size=(5, 5, 1), mode="nearest") for a in (pixels, seen))
    return np.maximum(total / np.maximum(share, 1 / 25), 0)
