"""Synthetic volumes: every file of this folder makes one, which users load by the file's name.

A file defines ``SIZE``, the default number of voxels along each axis; ``BYTES``, the memory per
voxel while it is made; and ``make(size)``, which returns the `Volume` of `size` (nx, ny, nz)
voxels.
"""

import importlib
import math
from functools import cache
from typing import Any

from brdfkit.core.discovery.plugin_files import find_module_names
from brdfkit.volumes.volume import Volume


@cache
def list_names() -> tuple[str, ...]:
    """Return the names of the synthetic volumes."""
    return find_module_names(__path__)


def memory_needed(name: str, size: tuple[int, int, int]) -> int:
    """Return the memory [bytes] that is needed to make a volume of this name and `size`."""
    return math.prod(size) * int(_load_module(name).BYTES)


def make(name: str, size: tuple[int, int, int] | None = None) -> Volume:
    """Make the volume of this name, with `size` (nx, ny, nz) voxels or its default size."""
    module = _load_module(name)
    volume: Volume = module.make(size or (module.SIZE,) * 3)
    return volume


def _load_module(name: str) -> Any:
    """Return the module that makes the volume of this name."""
    return importlib.import_module(f"{__name__}.{name}")
