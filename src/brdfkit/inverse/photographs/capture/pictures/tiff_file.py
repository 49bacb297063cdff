"""Reads TIFF photographs: of 8 bits by Pillow, and of 16 bits or floats by tifffile."""

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
            bits = np.max(picture.getexif().get(BITS_PER_SAMPLE, 8))
            # Pillow keeps only the upper 8 bits of colours of 16 bits
            if bits == 8 and picture.mode in ("L", "RGB", "RGBA"):
                return np.array(picture)
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
    if numbers.ndim not in (2, 3) or numbers.dtype.kind not in "uf":
        raise BrdfkitError(
            f"{path}: it has the shape {numbers.shape} of {numbers.dtype}; save it as one picture "
            "of grey or RGB."
        )
    return numbers
