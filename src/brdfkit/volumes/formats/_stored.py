"""`VolumeFile`, a file to find a volume in, and `Stored`: what its header says of the volume."""

import importlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import printable


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
        return BrdfkitError(f"{self.path}: {printable(' '.join(problem.split()))}.")

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
