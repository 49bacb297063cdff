"""Reads the pictures that `refine` has to match, and weighs their pixels."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray
from brdfkit.core.colours import from_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.mitsuba_bridge.properties.picture_file import read_photograph, read_pixels

# Share of the mean brightness that is added to pixels before weights are computed, so that weights
# of dark pixels stay finite
DARK_OFFSET = 0.02
WHITE_QUANTILE = 0.99  # quantile of a picture's values that counts as its white level
# a picture counts as clipped if more than this share of values equals the largest one
CLIPPED_SHARE = 1e-3

Pictures = FloatArray | str | Path | Iterable[FloatArray | str | Path]


@dataclass(frozen=True)
class Target:
    """A picture to match.

    pixels : linear values (height, width, channels).
    weights : the weight of each squared difference, in the same shape; 0 where the pixel is masked
        or clipped.
    count : the number of values that are not clipped, as the sum of their mask.
    clipped : the share of values that are clipped.
    unmasked : the mask (height, width) of pixels that count.
    """

    pixels: FloatArray
    weights: FloatArray
    count: float
    clipped: float
    unmasked: BoolArray

    @property
    def size(self) -> tuple[int, int]:
        """The width and height of the picture in pixels."""
        return self.pixels.shape[1], self.pixels.shape[0]


def read_targets(
    pictures: Pictures, accept_8_bit: bool = False, mask: Pictures | None = None
) -> list[Target]:
    """Return the `Target`s of one or several pictures, arrays (height, width[, channels]) or paths.

    `mask` has the weights of the pixels, see `read_masks`. Raises `BrdfkitError` for what is not a
    picture, for pixels that are not finite, and for pictures of 8 bits unless `accept_8_bit`, which
    inverts sRGB's curve.
    """
    value: Any = pictures
    alone = isinstance(value, str | Path) or getattr(value, "ndim", 4) < 4
    several = [value] if alone else list(value)
    if not several:
        raise BrdfkitError("there is no picture to match; give one for each sensor.")
    masks = read_masks(mask, len(several))
    return [
        _read_target(one, f"picture {number}", accept_8_bit, mask)
        for number, (one, mask) in enumerate(zip(several, masks, strict=True))
    ]


def _read_target(picture: Any, name: str, accept_8_bit: bool, mask: FloatArray | None) -> Target:
    """Return the `Target` of one picture; `name` is its name in errors."""
    if isinstance(picture, str | Path):
        picture, name = read_photograph(picture, accept_8_bit), str(picture)
    pixels: FloatArray = np.asarray(picture)
    if pixels.dtype == np.uint8:
        if not accept_8_bit:
            raise BrdfkitError(
                f"{name}: it has 8 bits and so is not linear; give linear pixels, as of an OpenEXR "
                "file, or give accept_8_bit=True to invert sRGB's curve."
            )
        pixels = from_srgb(pixels / 255.0)
    if pixels.ndim == 2:
        pixels = pixels[..., None]
    if pixels.ndim != 3 or pixels.shape[2] not in (1, 3, 4) or not pixels.size:
        raise BrdfkitError(
            f"{name}: its shape {pixels.shape} should be that of a picture, (height, width, 3)."
        )
    pixels = pixels[..., :3].astype(float)
    mask = np.ones(pixels.shape[:2]) if mask is None else mask
    if mask.shape != pixels.shape[:2]:
        raise BrdfkitError(
            f"{name}: its mask has the shape {mask.shape} and the picture {pixels.shape[:2]}; they "
            "should be equal."
        )
    pixels = np.where(mask[..., None] > 0, pixels, 0)
    finite = np.isfinite(pixels).all(axis=2)
    if not finite.all():
        raise BrdfkitError(f"{name}: {(~finite).sum():,} of its pixels are not finite.")
    if not pixels.max() > 0:
        raise BrdfkitError(f"{name}: it is black; nothing can be learned from it.")
    share = np.broadcast_to(mask[..., None], pixels.shape)
    clipped = _find_clipped(pixels, share > 0)
    share = np.where(clipped, 0, share)
    return Target(
        pixels,
        share * _weigh_pixels(pixels, mask > 0),
        share.sum(),
        float(clipped.sum() / (pixels.shape[2] * np.count_nonzero(mask))),
        mask > 0,
    )


def _find_clipped(pixels: FloatArray, counted: BoolArray) -> BoolArray:
    """Return the mask of `counted` values that are clipped at the largest value of the camera."""
    at_end = counted & (pixels == pixels.max())
    many = at_end.sum() > max(8, CLIPPED_SHARE * counted.sum())
    return at_end if many else np.zeros_like(at_end)


def _weigh_pixels(pixels: FloatArray, unmasked: BoolArray) -> FloatArray:
    """Return the weight of each squared difference of a rendered pixel, in the shape of `pixels`.

    The weight is the squared slope of sRGB's curve at the pixel's brightness, so that differences
    count as they are seen on a screen; for pixels brighter than white, relative differences count.
    The curve itself would bias noisy renderings, but its slope at the target picture does not.
    White level and means are taken over the `unmasked` pixels (height, width).
    """
    white = find_white_level(pixels[unmasked])
    x = (_average_neighbours(pixels, unmasked) + DARK_OFFSET * pixels[unmasked].mean()) / white
    shown = np.minimum(x, 1)
    slope = np.where(shown <= 0.0031308, 12.92, 1.055 / 2.4 * shown ** (1 / 2.4 - 1))
    return (slope / (white * np.maximum(x, 1))) ** 2


def find_white_level(pixels: AnyArray) -> Any:
    """Return the white level of a picture: 1 % of its values are brighter.

    Where most pixels are black, it is the largest value.
    """
    return np.quantile(pixels, WHITE_QUANTILE) or pixels.max()


def _average_neighbours(pixels: FloatArray, unmasked: BoolArray) -> FloatArray:
    """Return the mean of the `unmasked` pixels within 5 × 5 pixels around each pixel.

    A weight from a single pixel would correlate with its noise and bias the result.
    """
    from scipy.ndimage import uniform_filter

    share = unmasked[..., None].astype(float)
    total, share = (uniform_filter(a, size=(5, 5, 1), mode="nearest") for a in (pixels, share))
    return np.maximum(total / np.maximum(share, 1 / 25), 0)


def read_masks(mask: Any, count: int) -> list[FloatArray | None]:
    """Return a mask (height, width) of weights for each of `count` pictures, or None without masks.

    `mask` is None, an array or a path if there is one picture, or a sequence of these. Raises
    `BrdfkitError` for a wrong number of masks, and for a mask that is not a picture of weights ≥ 0,
    or is 0 everywhere.
    """
    if mask is None:
        return [None] * count
    alone = isinstance(mask, str | Path) or (count == 1 and isinstance(mask, np.ndarray))
    several = [mask] if alone else list(mask)
    if len(several) != count:
        raise BrdfkitError(
            f"refine: there should be one mask for each picture: {len(several)} for {count}."
        )
    return [None if one is None else _read_mask(one, number) for number, one in enumerate(several)]


def _read_mask(value: Any, number: int) -> FloatArray:
    """Return a mask (height, width) from an array or a path; `number` names it in errors."""
    name = f"refine: mask {number}"
    if isinstance(value, str | Path):
        name = str(value)
        value = read_pixels(require_file(value), name).mean(axis=2)
    mask: AnyArray = np.asarray(value)
    if mask.ndim != 2 or mask.dtype.kind not in "biuf":
        raise BrdfkitError(
            f"{name}: its shape {mask.shape} of {mask.dtype} should be (height, width) of booleans "
            "or weights."
        )
    weights = mask.astype(float)
    if not (np.isfinite(weights) & (weights >= 0)).all():
        raise BrdfkitError(f"{name}: its weights should be finite numbers ≥ 0.")
    if not weights.any():
        raise BrdfkitError(f"{name}: it is 0 everywhere; no pixel would count.")
    return weights
