"""Reads TIFF photographs: of 8 bits and grey ones by Pillow, all others by tifffile."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError

TIFF_SUFFIXES = ".tif", ".tiff"
BITS_PER_SAMPLE = 258  # tag of TIFF


def read_tiff(path: Path) -> AnyArray:
    """Read the numbers of a TIFF picture, (height, width) or (height, width, channels).

    Raises `BrdfkitError` for a damaged file, and for one of more than 8 bits if tifffile is
    missing.
    """
    from PIL import Image

    try:
        with Image.open(path) as picture:
            bits = np.max(picture.getexif().get(BITS_PER_SAMPLE, 1))
            # Pillow keeps only the upper 8 bits of colours of 16 bits
            if bits <= 8 or picture.mode.startswith("I;16"):
                as_numbers = {"1": "L", "P": "RGB", "CMYK": "RGB"}.get(picture.mode)
                return np.array(picture.convert(as_numbers) if as_numbers else picture)
    except (OSError, ValueError, SyntaxError):  # no TIFF, or one that Pillow does not know
        pass
    return _read_deep_tiff(path)


def _read_deep_tiff(path: Path) -> AnyArray:
    """Read the numbers of a TIFF picture by tifffile."""
    try:
        tifffile = importlib.import_module("tifffile")
    except ImportError as error:
        raise BrdfkitError(
            f'{path}: needs the package tifffile; pip install "brdfkit[raw]" brings it.'
        ) from error
    try:
        numbers = np.asarray(tifffile.imread(path, key=0))
    except KeyError as error:  # compression such as LZW
        raise BrdfkitError(
            f'{path}: its compression needs the package imagecodecs; pip install "brdfkit[raw]" '
            "brings it, or save the file without compression."
        ) from error
    except (OSError, ValueError, RuntimeError, IndexError, TypeError) as error:
        raise BrdfkitError(f"{path}: it is no TIFF, or it is damaged; save it again.") from error
    if numbers.ndim == 3 and numbers.shape[0] in (3, 4) and numbers.shape[2] > 4:
        numbers = np.moveaxis(numbers, 0, 2)  # a plane for each colour
    if numbers.ndim not in (2, 3) or numbers.dtype.kind not in "uf":
        raise BrdfkitError(
            f"{path}: it has the shape {numbers.shape} of {numbers.dtype}; save it as one picture "
            "of grey or RGB."
        )
    return numbers
