"""Synthetic volumes: each module of this folder makes one, which users load by the module's name.

A module defines ``SIZE``, the default number of voxels along each axis; ``BYTES``, the memory per
voxel that making the volume needs; and ``make(size)``, which returns the `Volume` of `size`
(nx, ny, nz) voxels.
"""

import importlib
import math
from functools import cache
from typing import Any

from brdfkit.core.discovery.plugin_files import find_module_names
from brdfkit.volumes.volume import Volume


@cache
def list_volume_names() -> tuple[str, ...]:
    """Return the names of the synthetic volumes."""
    return find_module_names(__path__)


def estimate_memory(name: str, size: tuple[int, int, int]) -> int:
    """Return the memory [bytes] that making the synthetic volume `name` in this `size` needs."""
    return math.prod(size) * int(_load_module(name).BYTES)


def make_volume(name: str, size: tuple[int, int, int] | None = None) -> Volume:
    """Make the synthetic volume `name`, with `size` (nx, ny, nz) voxels or its default size."""
    module = _load_module(name)
    volume: Volume = module.make(size or (module.SIZE,) * 3)
    return volume


def _load_module(name: str) -> Any:
    """Import the module that makes the synthetic volume `name`."""
    return importlib.import_module(f"{__name__}.{name}")
