"""Reads the photographs of a `Listing` one by one, and keeps the pixels of the object alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.memory import require_bytes
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.making_lights import check_count
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.capture.pictures.coding import Coding
from brdfkit.inverse.photographs.capture.pictures.masks import (
    describe_found_mask,
    find_object,
    read_mask,
)
from brdfkit.inverse.photographs.capture.pictures.photograph_file import read_linear
from brdfkit.inverse.photographs.capture.pictures.raw_file import require_raw_reader
from brdfkit.inverse.photographs.capture.scale import find_scale

# A photograph is unlit if its mean is less than this share of the median of all means
UNLIT = 1e-3
# Values equal to the largest one of a channel are clipped if they are more than this share
CLIPPED_SHARE = 1e-4
ALMOST = 0.9999  # share of the largest value of a format that is clipped; a demosaic may round it


def read_object(listing: Listing, coding: Coding | None) -> ObjectCapture:
    """Return the photographs of an object in a folder, as `listing` describes them.

    `coding` tells how the numbers of photographs are coded. Unlit photographs are left out with a
    note. Raises `BrdfkitError` for files that are missing, damaged or do not fit each other.
    """
    check_count(listing.lights_file, len(listing.lights), listing.photographs)
    require_raw_reader(listing.photographs)
    mask, notes = _find_mask(listing, coding)
    values, largest = _read_values(listing.photographs, mask, coding)
    pixel_size, distance, scale_notes = find_scale(listing, mask)
    capture = ObjectCapture(
        name=listing.name,
        values=values,
        mask=mask,
        lights=listing.lights,
        names=_find_names(listing.photographs),
        lost=find_clipped(values, largest),
        normals=None if listing.normals is None else _find_normals(listing, mask),
        pixel_size=pixel_size,
        distance=distance,
        notes=(*listing.notes, *notes, *scale_notes),
    )
    lit = _is_lit(values)
    if not lit.any():
        raise BrdfkitError(
            f"{listing.photographs[0].parent}: all photographs are black where the object is; "
            "check their exposure, and the mask."
        )
    return leave_out(capture, lit, "unlit")


def find_clipped(values: FloatArray, largest: float) -> BoolArray:
    """Return which values (lights, n, 3) are those of a saturated sensor.

    They equal the largest value that the format has, or the largest value of their channel if that
    occurs often: a white balance scales the colours, so that each is saturated at its own value.
    """
    clipped = np.empty(values.shape, bool)
    for channel in range(3):
        own = values[..., channel]
        top = own.max()
        at_top = own >= top
        often = top > 0 and at_top.sum() > max(1, CLIPPED_SHARE * own.size)
        clipped[..., channel] = (at_top & often) | (own >= ALMOST * largest)
    return clipped


def _find_mask(listing: Listing, coding: Coding | None) -> tuple[BoolArray, tuple[str, ...]]:
    """Return which pixels show the object, and sentences on how they were found."""
    if listing.mask is not None:
        return read_mask(listing.mask), ()
    first = listing.photographs[0]
    brightest = read_linear(first, coding)[0].max(axis=2)
    for path in listing.photographs[1:]:
        grey = read_linear(path, coding)[0].max(axis=2)
        _check_shape(path, grey, brightest.shape, first.name)
        np.maximum(brightest, grey, out=brightest)
    mask = find_object(brightest)
    if mask.sum() == 0:
        raise BrdfkitError(f"{first.parent}: all photographs are black; check their exposure.")
    return mask, (describe_found_mask(mask, len(listing.photographs)),)


def _read_values(
    photographs: tuple[Path, ...], mask: BoolArray, coding: Coding | None
) -> tuple[FloatArray, float]:
    """Return the values (lights, n, 3) within the mask, and the largest value of the format."""
    count = int(mask.sum())
    require_bytes(len(photographs) * count * 3 * 5, f"{photographs[0].parent}: the photographs")
    values: FloatArray = np.empty((len(photographs), count, 3), np.float32)
    largest = np.inf
    for path, own in zip(photographs, values, strict=True):
        picture, largest = read_linear(path, coding)
        _check_shape(path, picture, mask.shape, "the mask")
        own[:] = picture[mask]
        bad = int((~np.isfinite(own)).any(axis=1).sum())
        if bad:
            raise BrdfkitError(
                f"{path}: {bad:,} of its pixels are not finite; paint them black in the mask."
            )
    np.maximum(values, 0, out=values)
    return values, largest


def _find_names(photographs: tuple[Path, ...]) -> tuple[str, ...]:
    """Return names of photographs: those of their files, with their folders if they are equal."""
    names = tuple(path.name for path in photographs)
    if len(set(names)) == len(names):
        return names
    return tuple(f"{path.parent.name}/{path.name}" for path in photographs)


def _check_shape(path: Path, picture: FloatArray, shape: tuple[int, ...], other: str) -> None:
    """Raise `BrdfkitError` unless a picture has the `shape` (height, width) of the `other` one."""
    if picture.shape[:2] != shape:
        own, first = (f"{s[1]} × {s[0]}" for s in (picture.shape, shape))
        raise BrdfkitError(
            f"{path}: it has {own} pixels, and {other} {first}; they should be alike."
        )


def _find_normals(listing: Listing, mask: BoolArray) -> FloatArray:
    """Return the true unit normals (n, 3) within the mask.

    Raises `BrdfkitError` for normals of another size than the photographs.
    """
    normals = np.asarray(listing.normals, float)
    if normals.shape != (*mask.shape, 3):
        raise BrdfkitError(
            f"{listing.photographs[0].parent}: its true normals have the shape {normals.shape}, "
            f"and the photographs {mask.shape}; they should be alike."
        )
    inside = normals[mask]
    length = np.linalg.norm(inside, axis=1, keepdims=True)
    return np.divide(inside, length, out=np.full_like(inside, np.nan), where=length > 0)


def _is_lit(values: FloatArray) -> BoolArray:
    """Return which of the photographs (lights, n, 3) are not black compared with the others."""
    means = values.mean(axis=(1, 2), dtype=float)
    lit: BoolArray = means > UNLIT * np.median(means)
    return lit


def leave_out(capture: ObjectCapture, kept: BoolArray, reason: str) -> ObjectCapture:
    """Return the photographs that are `kept` (lights,), with a note on the others."""
    if kept.all():
        return capture
    names = [name for name, keep in zip(capture.names, kept, strict=True) if not keep]
    shown = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    note = f"{len(names)} of {len(kept)} photographs were left out, as they are {reason}: {shown}."
    left = capture.select_lights(np.flatnonzero(kept))
    return replace(left, notes=(*capture.notes, note))
