"""`VolumeFile`, a file with a volume to be read, and `StoredVolume`, the content of its header."""

import importlib
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_printable

Shape = tuple[int, int, int]  # (nz, ny, nx), the numbers of voxels along z, y, x

# Converts DICOM's and ITK's world, x to the left and y to the back, to x right and y front
LPS_TO_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])

_confined: ContextVar[bool] = ContextVar("confined", default=False)


@contextmanager
def confine_headers() -> Iterator[None]:
    """Let headers name only files of their own folder within the block.

    Otherwise a header from elsewhere could show any file of this computer as voxels.
    """
    token = _confined.set(True)
    try:
        yield
    finally:
        _confined.reset(token)


def list_files(folder: Path) -> list[Path]:
    """Return the files of a folder sorted by name, without hidden files."""
    return sorted(p for p in Path(folder).iterdir() if p.is_file() and p.name[0] != ".")


def list_tiffs(folder: Path) -> list[Path]:
    """Return the TIFF files of a folder."""
    return [p for p in list_files(folder) if p.suffix.lower() in (".tif", ".tiff")]


def find_format_of_folder(file: "VolumeFile") -> str:
    """Return the format of the files in a folder, "tiff" or "dicom"."""
    if not list_files(file.path):
        raise file.error("the folder is empty; name one with DICOM slices or TIFF files")
    return "tiff" if list_tiffs(file.path) else "dicom"


def read_first_bytes(path: Path, size: int) -> bytes:
    """Return the first `size` bytes of a file; return b"" if it cannot be read."""
    try:
        with path.open("rb") as stream:
            return stream.read(size)
    except OSError:
        return b""


def make_grid_transform(directions: ArrayLike, spacing: ArrayLike, origin: ArrayLike) -> FloatArray:
    """Return the transform (4, 4) from the indices (i, j, k) of voxels to the world.

    The columns of `directions` (3, 3) are the grid's axes, `spacing` (3,) are the distances between
    voxels along them, and `origin` (3,) is the centre of the first voxel.
    """
    to_world = np.eye(4)
    to_world[:3, :3] = np.asarray(directions, float) * np.asarray(spacing, float)
    to_world[:3, 3] = origin
    return to_world


@dataclass(frozen=True)
class VolumeFile:
    """A file or folder that contains a volume, and the user's settings for reading it.

    `part` is the text behind '#' in the user's path, which chooses one of several volumes in the
    file, or None. `size` (nx, ny, nz), `dtype` and `offset` [bytes] describe raw voxels, which have
    no header; they are None if the user does not give them.
    """

    path: Path
    part: str | None = None
    size: tuple[int, int, int] | None = None
    dtype: Any = None
    offset: int | None = None

    def find_voxel_file(self, name: str) -> Path:
        """Return the path of the file with the voxels, which this file's header calls `name`.

        Within `confine_headers`, it is the file of that name in the header's folder, whatever
        folder the header names.
        """
        folder = self.path.parent
        if not _confined.get():
            return folder / name
        path = folder / re.split(r"[/\\]", name)[-1]
        if os.path.exists(path) and path.resolve().parent != folder.resolve():  # a link, or ".."
            raise self.error("its header names a file of another folder; put the two in one")
        return path

    def error(self, problem: str) -> BrdfkitError:
        """Return a `BrdfkitError` that names this file and describes the `problem`.

        `problem` says what is wrong and what to do, without a full stop. Line breaks and control
        characters, which a quoted header may contain, are removed.
        """
        return BrdfkitError(f"{self.path}: {to_printable(' '.join(problem.split()))}.")

    def import_package(self, name: str, brings: str) -> ModuleType:
        """Import the optional package `name`, which reads this file's format.

        If it is missing, the `BrdfkitError` says how to install it by its name on PyPI, `brings`.
        """
        try:
            return importlib.import_module(name)
        except ImportError as error:
            raise self.error(
                f'needs the package {brings}; pip install "brdfkit[volumes]" brings it'
            ) from error


@dataclass(frozen=True)
class StoredVolume:
    """A volume whose header has been read from a file, and whose voxels have not.

    `shape` is (nz, ny, nx). `layers()` reads the voxels, and yields an array (ny, nx) of this
    `dtype` for each z. `to_world`, `labels`, `unit` and `axes` have the meaning that they have in
    `Volume`.
    """

    shape: Shape
    dtype: np.dtype[Any]
    layers: Callable[[], Iterator[AnyArray]] = field(repr=False)
    to_world: FloatArray
    labels: bool = False
    unit: str = ""
    axes: str = ""
