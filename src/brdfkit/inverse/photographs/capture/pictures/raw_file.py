"""Reads camera RAW files as linear colours by rawpy, which is LibRaw."""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError

RAW_SUFFIXES = (
    *(".3fr", ".arw", ".cr2", ".cr3", ".crw", ".dng", ".erf", ".iiq", ".kdc", ".mrw", ".nef"),
    *(".nrw", ".orf", ".pef", ".raf", ".raw", ".rw2", ".rwl", ".sr2", ".srf", ".srw", ".x3f"),
)


def require_raw_reader(paths: Iterable[Path]) -> None:
    """Raise `BrdfkitError` before any work if there are RAW files and rawpy is missing."""
    first = next((path for path in paths if path.suffix.lower() in RAW_SUFFIXES), None)
    if first is not None:
        _import_rawpy(first)


def read_raw(path: Path) -> AnyArray:
    """Read the numbers (height, width, 3), uint16, of a RAW file, in proportion to light.

    Colours are those of the camera with its own white balance, in linear sRGB; the brightness is
    not adapted, so that photographs stay comparable. Raises `BrdfkitError` for a damaged file, and
    if rawpy is missing.
    """
    rawpy = _import_rawpy(path)
    try:
        with rawpy.imread(str(path)) as raw:
            return np.asarray(
                raw.postprocess(
                    gamma=(1, 1), no_auto_bright=True, use_camera_wb=True, output_bps=16
                )
            )
    except rawpy.LibRawError as error:
        raise BrdfkitError(
            f"{path}: LibRaw cannot read it ({error}); copy it again, or convert it to DNG."
        ) from error


def _import_rawpy(path: Path) -> ModuleType:
    """Import rawpy, which reads the file at `path`."""
    try:
        return importlib.import_module("rawpy")
    except ImportError as error:
        raise BrdfkitError(
            f'{path}: needs the package rawpy; pip install "brdfkit[raw]" brings it.'
        ) from error
