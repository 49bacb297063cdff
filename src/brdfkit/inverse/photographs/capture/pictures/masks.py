"""Reads masks of objects, and finds the pixels of an object where there is no mask."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy import ndimage

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.pictures.photograph_file import (
    is_mask,
    is_photograph,
    read_numbers,
)

BINS = 256  # of the histogram that Otsu's threshold divides
SMALLEST_OBJECT = 16  # pixels
# A background was made black if pixels that are nearly black, below this share of the largest
# value, are few, below this share of those that are black
NEARLY_BLACK, FEW = 0.01, 0.05
LARGEST_HOLE = 0.005  # share of the object that a hole may have and be filled


def find_mask_file(folder: Path) -> Path | None:
    """Return the file in a folder whose name ends in mask, or begins with it; None without one."""
    found = [file for file in sorted(folder.iterdir()) if is_photograph(file) and is_mask(file)]
    if len(found) > 1:
        names = " and ".join(file.name for file in found[:2])
        raise BrdfkitError(f"{folder}: {names} could both be the mask; leave one of them.")
    return found[0] if found else None


def read_mask(path: Path) -> BoolArray:
    """Read which pixels (height, width) of a photograph show the object: those that are bright.

    A mask that is white where it is transparent counts by its alpha channel. Raises `BrdfkitError`
    for a mask without an object.
    """
    numbers = read_numbers(path)
    if numbers.ndim == 3:
        colours = {2: 1, 4: 3}.get(numbers.shape[2], numbers.shape[2])
        alpha = numbers[..., colours:]
        numbers = numbers[..., :colours].max(axis=2)
        if alpha.size and np.ptp(alpha) > 0:
            numbers = np.minimum(numbers, alpha[..., 0])
    mask: BoolArray = numbers > numbers.max() / 2
    if mask.sum() < SMALLEST_OBJECT:
        raise BrdfkitError(
            f"{path}: only {mask.sum()} of its pixels are white, and show the object; paint it "
            "white on black."
        )
    return mask


def find_object(brightest: FloatArray) -> BoolArray:
    """Return the pixels of an object (height, width) in front of a dark background.

    `brightest` is the largest value of each pixel in all photographs. If the background was made
    black, all else is the object. Otherwise Otsu's threshold divides the values, on a scale of
    their square roots, into those of the background and those of the object. Its largest piece is
    returned, with small holes filled, such as the pupil of an eye.
    """
    black = brightest <= 0
    nearly_black = ~black & (brightest < NEARLY_BLACK * brightest.max())
    if nearly_black.sum() < FEW * black.sum():
        mask = ~black
    else:
        mask = np.sqrt(brightest) > find_threshold(np.sqrt(brightest))
    mask = _select_pieces(mask, lambda sizes: sizes == sizes.max())
    holes = ndimage.binary_fill_holes(mask) & ~mask
    largest = LARGEST_HOLE * mask.sum()
    return mask | _select_pieces(holes, lambda sizes: sizes < largest)


def _select_pieces(mask: BoolArray, choose: Callable[[IntArray], BoolArray]) -> BoolArray:
    """Return the connected pieces of a mask that a function chooses by their sizes [pixels]."""
    pieces, count = ndimage.label(mask)
    if count == 0:
        return mask
    chosen = np.concatenate([[False], choose(np.bincount(pieces.ravel())[1:])])
    selected: BoolArray = chosen[pieces]
    return selected


def find_threshold(values: FloatArray) -> float:
    """Return the value that divides values into two classes of the least variance [Otsu 1979]."""
    counts, edges = np.histogram(values, BINS)
    centres = (edges[1:] + edges[:-1]) / 2
    below = np.cumsum(counts)
    above = below[-1] - below
    first = np.cumsum(counts * centres)
    with np.errstate(divide="ignore", invalid="ignore"):
        between = below * above * (first / below - (first[-1] - first) / above) ** 2
    return float(edges[1 + np.nanargmax(np.nan_to_num(between))])


def describe_found_mask(mask: BoolArray, photographs: int) -> str:
    """Return a sentence on a mask that was found in a number of photographs."""
    share = 100 * mask.mean()
    return (
        f"there is no mask: the object was taken to be the {mask.sum():,} pixels ({share:.0f} %) "
        f"that are bright in one of the {photographs} photographs; a file mask.png, white on "
        "black, would say so."
    )
