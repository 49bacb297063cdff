"""`VolumeFile`, a file with a volume, and `StoredVolume`, the volume that its header describes."""

import importlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_printable

Shape = tuple[int, int, int]  # nz, ny, nx

TIFF = ".tif", ".tiff"


def list_files(folder: Path) -> list[Path]:
    """Return the files of a folder, without hidden ones, sorted by name."""
    return sorted(p for p in Path(folder).iterdir() if p.is_file() and p.name[0] != ".")


def list_tiffs(folder: Path) -> list[Path]:
    """Return the TIFF files of a folder."""
    return [p for p in list_files(folder) if p.suffix.lower() in TIFF]


def folder_format(file: "VolumeFile") -> str:
    """Return the name of the format of a folder, "tiff" or "dicom"."""
    if not list_files(file.path):
        raise file.error("the folder is empty; name one with a series of DICOM or a stack of TIFF")
    return "tiff" if list_tiffs(file.path) else "dicom"


def read_head(path: Path, size: int) -> bytes:
    """Return the first bytes of a file, none if it cannot be read."""
    try:
        with path.open("rb") as stream:
            return stream.read(size)
    except OSError:
        return b""


LPS_TO_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])


def make_transform(directions: ArrayLike, spacing: ArrayLike, origin: ArrayLike) -> FloatArray:
    """Return the transform (4, 4) of a grid with axes `directions`, the columns of (3, 3).

    `spacing` and `origin` are (3,).
    """
    to_world = np.eye(4)
    to_world[:3, :3] = np.asarray(directions, float) * np.asarray(spacing, float)
    to_world[:3, 3] = origin
    return to_world


@dataclass(frozen=True)
class VolumeFile:
    """A file or a folder with a volume.

    `part` is the text behind '#' in the path, or None. `size` (nx, ny, nz), `dtype` and `offset`
    describe raw data, and are None if the user does not give them.
    """

    path: Path
    part: str | None = None
    size: tuple[int, int, int] | None = None
    dtype: Any = None
    offset: int | None = None

    def error(self, problem: str) -> BrdfkitError:
        """Return a `BrdfkitError` that names this file.

        `problem` says what is wrong and what to do, without a full stop. Line breaks and control
        characters, which may come from quoted headers, are removed.
        """
        return BrdfkitError(f"{self.path}: {to_printable(' '.join(problem.split()))}.")

    def import_package(self, name: str, brings: str) -> ModuleType:
        """Import the package `name`, which reads this format; if missing, say how to install it."""
        try:
            return importlib.import_module(name)
        except ImportError as error:
            raise self.error(
                f'needs the package {brings}; pip install "brdfkit[volumes]" brings it'
            ) from error


@dataclass(frozen=True)
class StoredVolume:
    """A volume in a file whose header has been read.

    `shape` is (nz, ny, nx). `layers()` yields the voxels, arrays (ny, nx) of this `dtype` in the
    order of z. `to_world`, `labels`, `unit` and `axes` are those of the `Volume`.
    """

    shape: Shape
    dtype: np.dtype[Any]
    layers: Callable[[], Iterator[AnyArray]] = field(repr=False)
    to_world: FloatArray
    labels: bool = False
    unit: str = ""
    axes: str = ""
