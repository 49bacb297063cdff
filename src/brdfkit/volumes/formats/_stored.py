"""`VolumeFile`, a file to find a volume in, and `Stored`: what its header says of the volume."""

import importlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_printable

TIFF = ".tif", ".tiff"


def files(folder):
    """The files of a folder, without hidden ones, by name."""
    return sorted(p for p in Path(folder).iterdir() if p.is_file() and p.name[0] != ".")


def pictures(folder):
    """The TIFF files of a folder."""
    return [p for p in files(folder) if p.suffix.lower() in TIFF]


def kind(file):
    """The name of the format of a folder, "tiff" or "dicom"."""
    if not files(file.path):
        raise file.error("the folder is empty; name one with a series of DICOM or a stack of TIFF")
    return "tiff" if pictures(file.path) else "dicom"


def head(path, size):
    """The first bytes of a file; none of one that cannot be read."""
    try:
        with path.open("rb") as stream:
            return stream.read(size)
    except OSError:
        return b""


LPS_TO_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])


def transform(directions, spacing, origin):
    """(4, 4) of a grid: a column of `directions` (3, 3) for each axis, `spacing`, `origin` (3,)."""
    to_world = np.eye(4)
    to_world[:3, :3] = np.asarray(directions, float) * np.asarray(spacing, float)
    to_world[:3, 3] = origin
    return to_world


@dataclass(frozen=True)
class VolumeFile:
    """A file or a folder to find a volume in.

    `part`: the text behind '#' in the path, or None; `size`, `dtype`, `offset`: what the user says
    of raw data, None where he does not.
    """

    path: Path
    part: str | None = None
    size: tuple[int, int, int] | None = None
    dtype: Any = None
    offset: int | None = None

    def error(self, problem):
        """A `BrdfkitError` that names this file; `problem`: what is wrong and what to do, without a
        full stop. Of what it quotes from headers, ends of lines and control characters go."""
        return BrdfkitError(f"{self.path}: {to_printable(' '.join(problem.split()))}.")

    def package(self, name, brings):
        """The package `name`, which reads this format; how to install it where it is missing."""
        try:
            return importlib.import_module(name)
        except ImportError as error:
            raise self.error(
                f'needs the package {brings}; pip install "brdfkit[volumes]" brings it'
            ) from error


@dataclass(frozen=True)
class Stored:
    """A volume in a file, of which the header was read.

    `shape`: (nz, ny, nx); `dtype`: of the layers; `layers()`: gives them, (ny, nx), in the order of
    z; `to_world`, `labels`, `unit`, `axes`: as `Volume` has them.
    """

    shape: tuple[int, int, int]
    dtype: np.dtype
    layers: Callable[[], Iterator[np.ndarray]] = field(repr=False)
    to_world: np.ndarray
    labels: bool = False
    unit: str = ""
    axes: str = ""
