"""Volumes that are made, not loaded: every file of this folder is one, by its name.

Such a file defines ``SIZE``, the number of voxels along each axis by default, ``BYTES``, the memory
that a voxel takes, and ``make(size)``, the `Volume` of `size` (nx, ny, nz) voxels. What is known of
it exactly stands beside that.
"""

import importlib
import math
from functools import cache

from brdfkit.core.discovery.plugin_files import find_module_names


@cache
def names():
    """The names of the made volumes."""
    return find_module_names(__path__)


def needed(name, size):
    """The memory [bytes] in which the volume of that name and `size` is made."""
    return math.prod(size) * _module(name).BYTES


def make(name, size=None):
    """The made volume of that name; `size`: (nx, ny, nz), by default its own."""
    module = _module(name)
    return module.make(size or (module.SIZE,) * 3)


def _module(name):
    return importlib.import_module(f"{__name__}.{name}")
