"""Volumes that are made, not loaded: every file of this folder is one, by its name.

Such a file defines ``SIZE``, the number of voxels along each axis by default, and ``make(size)``,
the `Volume` of `size` (nx, ny, nz) voxels. What is known of it exactly stands beside that.
"""

import importlib
from functools import cache

from brdfkit.modules import names_in


@cache
def names():
    """The names of the made volumes."""
    return names_in(__path__)


def make(name, size=None):
    """The made volume of that name; `size`: (nx, ny, nz), by default its own."""
    module = importlib.import_module(f"{__name__}.{name}")
    return module.make(size or (module.SIZE,) * 3)
