"""Reads masks of objects, and finds the pixels of an object where there is no mask."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy import ndimage

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.pictures.photograph_file import (
    is_mask,
    is_photograph,
    read_numbers,
)

BINS = 256  # of the histogram that Otsu's threshold divides
SMALLEST_OBJECT = 16  # pixels


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


def find_object(brightest: FloatArray, darkest: FloatArray) -> BoolArray:
    """Return the pixels of an object (height, width) in front of a dark background.

    `brightest` and `darkest` are the largest and smallest values of each pixel in all photographs.
    Otsu's threshold divides the brightest values, on a scale of their square roots, into those of
    the background and those of the object, whose largest piece without holes is returned.
    """
    if darkest.max() > 0 and (brightest > 0).mean() < 0.95:  # the background was made black
        mask = brightest > 0
    else:
        mask = np.sqrt(brightest) > find_threshold(np.sqrt(brightest))
    pieces, count = ndimage.label(mask)
    if count > 1:
        sizes = np.bincount(pieces.ravel())[1:]
        mask = pieces == 1 + np.argmax(sizes)
    filled: BoolArray = ndimage.binary_fill_holes(mask)
    return filled


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
