"""Reads the linear values of a photograph of any format, and at which value it is clipped."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.core.jit.llvm import use_variant
from brdfkit.inverse.photographs.capture.pictures.coding import ADVICE, Coding
from brdfkit.inverse.photographs.capture.pictures.raw_file import RAW_SUFFIXES, read_raw
from brdfkit.inverse.photographs.capture.pictures.tiff_file import TIFF_SUFFIXES, read_tiff
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.mitsuba_bridge.properties.radiance_rows import require_intact_rows

# Formats that Mitsuba reads
MITSUBA_SUFFIXES = ".exr", ".png", ".jpg", ".jpeg", ".hdr", ".rgbe", ".pfm", ".bmp", ".tga", ".ppm"
EIGHT_BIT_SUFFIXES = ".jpg", ".jpeg", ".bmp", ".tga"
SUFFIXES = (*MITSUBA_SUFFIXES, *TIFF_SUFFIXES, *RAW_SUFFIXES)


class EightBitError(BrdfkitError):
    """The error for a photograph of 8 bits where nobody has said how its numbers are coded."""


def is_photograph(path: Path) -> bool:
    """Return whether a file is there, and is a photograph by its suffix."""
    return has_photograph_suffix(path.name) and not path.name.startswith(".") and path.is_file()


def has_photograph_suffix(name: str) -> bool:
    """Return whether the name of a file ends in the suffix of a photograph."""
    return name.lower().endswith(SUFFIXES)


def list_photographs(folder: Path) -> tuple[Path, ...]:
    """Return the photographs in a folder, in the order of the numbers in their names.

    Masks, whose names begin with mask or end in it, are left out, and so are pictures of normals.
    """
    files = (file for file in folder.iterdir() if is_photograph(file) and not is_mask(file))
    files = (file for file in files if not file.stem.lower().startswith("normal"))
    return tuple(sorted(files, key=_order_numbers))


def is_mask(path: Path) -> bool:
    """Return whether the name of a picture is that of a mask."""
    stem = path.stem.lower()
    return stem.startswith("mask") or stem.endswith("mask")


def _order_numbers(path: Path) -> list[tuple[str, int]]:
    """Return a key that sorts names by the numbers in them, so that 2 comes before 10."""
    return [(word, int(part or 0)) for word, part in re.findall(r"(\D*)(\d*)", path.name)]


def read_linear(path: Path, coding: Coding | None) -> tuple[FloatArray, float]:
    """Read a photograph's linear values (height, width, 3), float32, and its largest possible one.

    Whole numbers are divided by the largest one of their type, so that the largest value is 1; it
    is infinite for files of floats. `coding` tells how whole numbers are coded, except those of
    RAW files; without it numbers of 16 bits are linear. Raises `BrdfkitError` for a file that is
    missing, damaged, or has 8 bits without a `coding`.
    """
    error = EightBitError(f"{path}: it has 8 bits; {ADVICE}.")
    if path.suffix.lower() in EIGHT_BIT_SUFFIXES and coding is None:
        raise error
    numbers = read_numbers(path)
    if numbers.dtype.kind == "f":
        return _to_colours(path, numbers.astype(np.float32, copy=False)), np.inf
    if numbers.dtype.itemsize == 1 and coding is None:
        raise error
    values = numbers.astype(np.float32) / np.float32(np.iinfo(numbers.dtype).max)
    if coding is not None and path.suffix.lower() not in RAW_SUFFIXES:
        values = coding.decode(values)
    return _to_colours(path, values), 1.0


def read_numbers(path: Path) -> AnyArray:
    """Read the numbers of a picture as they are in the file, (height, width) or with channels.

    Raises `BrdfkitError` for a file that is missing or damaged.
    """
    path = require_file(path)
    suffix = path.suffix.lower()
    if suffix in TIFF_SUFFIXES:
        return read_tiff(path)
    if suffix in RAW_SUFFIXES:
        return read_raw(path)
    use_variant()
    require_intact_rows(path, path)
    return load_by_mitsuba(_read_bitmap, str(path), path)


def _read_bitmap(path: str, parallel: bool) -> AnyArray:
    """Read the numbers of a picture by Mitsuba; `parallel` is an argument of Mitsuba's loaders."""
    import mitsuba as mi

    return np.array(mi.Bitmap(path))


def _to_colours(path: Path, values: FloatArray) -> FloatArray:
    """Return values (height, width, 3); grey is repeated, and an alpha channel is left out."""
    if values.ndim == 2:
        values = values[..., None]
    channels = values.shape[2]
    if channels > 4:
        raise BrdfkitError(f"{path}: it has {channels} channels; save it as grey or RGB.")
    colours = values[..., :3] if channels >= 3 else np.repeat(values[..., :1], 3, axis=2)
    return np.ascontiguousarray(colours)
