"""Reads the pictures that `refine` has to match, and weighs their pixels."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray
from brdfkit.core.colours import from_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.inverse.scenes.problem.by_picture import Pictures, arrange_by_picture, name_pictures
from brdfkit.mitsuba_bridge.properties.picture_file import read_photograph, read_pixels

# Share of the mean brightness that is added to pixels before weights are computed, so that weights
# of dark pixels stay finite
DARK_OFFSET = 0.02
WHITE_QUANTILE = 0.99  # quantile of a picture's values that counts as its white level
# Least white level of a picture, as a share of that of the brightest one; without it, the noise of
# a picture that is nearly black would count more than all other pictures
DARKEST_WHITE = 0.1
# So many values that equal the largest one of their channel are clipped; noise does not repeat
FEWEST_CLIPPED = 3


@dataclass(frozen=True)
class Target:
    """A picture to match.

    name : the picture's name, or its number as text.
    pixels : linear values (height, width, channels).
    weights : the weight of each squared difference, in the same shape; 0 where the pixel is masked,
        clipped or beside a clipped one, and everywhere in a picture that is black.
    count : the number of values that count, as the sum of their mask.
    clipped : the share of values that are clipped.
    unmasked : the mask (height, width) of pixels that count.
    """

    name: str
    pixels: FloatArray
    weights: FloatArray
    count: float
    clipped: float
    unmasked: BoolArray

    @property
    def size(self) -> tuple[int, int]:
        """The width and height of the picture in pixels."""
        return self.pixels.shape[1], self.pixels.shape[0]

    @property
    def is_black(self) -> bool:
        """Whether the picture is black, so that it tells no more than a flash that failed."""
        return not self.pixels.any()


def read_targets(pictures: Pictures, accept_8_bit: bool = False, mask: Any = None) -> list[Target]:
    """Return the `Target`s of one or several pictures, arrays (height, width[, channels]) or paths.

    `mask` has the weights of the pixels, see `read_masks`. Raises `BrdfkitError` for what is not a
    picture, for pixels that are not finite, for pictures of 8 bits unless `accept_8_bit`, which
    inverts sRGB's curve, and if all pictures are black.
    """
    named = name_pictures(pictures)
    is_named = isinstance(pictures, Mapping)
    labels = {name: name if is_named else f"picture {name}" for name in named}
    masks = read_masks(mask, tuple(named))
    read = [
        _read_picture(picture, labels[name], accept_8_bit, mask)
        for (name, picture), mask in zip(named.items(), masks, strict=True)
    ]
    whites = [float(find_white_level(pixels[share > 0])) for pixels, share in read]
    if not max(whites) > 0:
        which = f"{labels[next(iter(named))]}: it is" if len(read) == 1 else "all pictures are"
        raise BrdfkitError(f"{which} black; nothing can be learned from it.")
    return [
        _make_target(name, pixels, share, max(white, DARKEST_WHITE * max(whites)))
        for name, (pixels, share), white in zip(named, read, whites, strict=True)
    ]


def _read_picture(
    picture: Any, name: str, accept_8_bit: bool, mask: FloatArray | None
) -> tuple[FloatArray, FloatArray]:
    """Return linear pixels (height, width, channels) and their mask (height, width).

    `name` is the picture's name in errors. Masked pixels are 0.
    """
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
    return pixels, mask


def _make_target(name: str, pixels: FloatArray, mask: FloatArray, white: float) -> Target:
    """Return the `Target` of linear pixels with their mask (height, width) and white level."""
    from scipy.ndimage import binary_dilation

    share = np.broadcast_to(mask[..., None], pixels.shape) * float(pixels.any())
    clipped = _find_clipped(pixels, share > 0)
    # Neighbours do not count either: of pixels about as bright as the limit, noise clips the bright
    # ones, so those left are too dark; and a program may have blended them with clipped ones
    share = np.where(binary_dilation(clipped, np.ones((3, 3, 1), bool)), 0, share)
    return Target(
        name,
        pixels,
        share * _weigh_pixels(pixels, mask > 0, white),
        share.sum(),
        float(clipped.sum() / (pixels.shape[2] * np.count_nonzero(mask))),
        mask > 0,
    )


def _find_clipped(pixels: FloatArray, counted: BoolArray) -> BoolArray:
    """Return the mask of `counted` values that are clipped at the largest value of the camera.

    Each channel is clipped at a value of its own, because a white balance scales the channels.
    """
    largest = np.where(counted, pixels, 0).max(axis=(0, 1))
    at_end: BoolArray = counted & (pixels == largest) & (largest > 0)
    return at_end & (at_end.sum(axis=(0, 1)) >= FEWEST_CLIPPED)


def _weigh_pixels(pixels: FloatArray, unmasked: BoolArray, white: float) -> FloatArray:
    """Return the weight of each squared difference of a rendered pixel, in the shape of `pixels`.

    The weight is the squared slope of sRGB's curve at the pixel's brightness, so that differences
    count as they are seen on a screen; for pixels brighter than `white`, relative differences
    count. The curve itself would bias noisy renderings, but its slope at the target picture does
    not. Means are taken over the `unmasked` pixels (height, width).
    """
    x = (_average_neighbours(pixels, unmasked) + DARK_OFFSET * pixels[unmasked].mean()) / white
    shown = np.minimum(x, 1)
    curved = 1.055 / 2.4 * np.maximum(shown, 0.0031308) ** (1 / 2.4 - 1)
    slope = np.where(shown <= 0.0031308, 12.92, curved)
    weight: FloatArray = (slope / (white * np.maximum(x, 1))) ** 2
    return weight


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


def read_masks(mask: Any, names: tuple[str, ...]) -> list[FloatArray | None]:
    """Return a mask (height, width) of weights for each of the pictures `names`, or None.

    `mask` is None, an array or a path if there is one picture, or a sequence or mapping of these.
    Raises `BrdfkitError` for a wrong number of masks, and for a mask that is not a picture of
    weights ≥ 0, or is 0 everywhere.
    """
    if mask is None:
        return [None] * len(names)
    alone = isinstance(mask, str | Path) or (len(names) == 1 and isinstance(mask, np.ndarray))
    several = arrange_by_picture("mask", "mask", [mask] if alone else mask, names)
    return [
        None if one is None else _read_mask(one, name)
        for name, one in zip(names, several, strict=True)
    ]


def _read_mask(value: Any, name: str) -> FloatArray:
    """Return a mask (height, width) from an array or a path; the picture's `name` is in errors."""
    name = f"refine: mask {name}"
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
