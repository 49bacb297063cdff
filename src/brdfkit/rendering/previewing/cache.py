"""Measured materials that are kept between previews: what their files hold, and their BSDFs."""

from functools import lru_cache
from pathlib import Path

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.loading import locate
from brdfkit.materials.measured import Measured
from brdfkit.materials.resolve import to_material
from brdfkit.rendering.scene_input.shown_material import load_material

MOST = 8  # materials; a table of MERL's size takes some 50 MB


def keep(thing):
    """`thing`, a thing to render; in the place of a file, what it holds, read when it changes."""
    if isinstance(thing, tuple):
        return *thing[:-1], keep(thing[-1])
    if not isinstance(thing, str | Path):
        return thing
    try:
        path, _ = locate(thing)
        found = path.stat()
    except (BrdfkitError, OSError, ValueError):
        return thing  # a model's name; or whoever reads it will say what is wrong
    return _read(str(thing), path.absolute(), found.st_mtime_ns, found.st_size)


@lru_cache(MOST)
def _read(name, path, changed, size):
    """The material that a name stands for, whose file `path` was `changed` at a time."""
    return to_material(name)


def bsdf_of(found, name, variant, both_sides):
    """The BSDF of a material in the current `variant`, see `load_material`; kept of a `Measured`,
    whose table takes long to prepare."""
    if isinstance(found, Measured):
        return _measured_bsdf(found, variant, both_sides)
    return load_material(found.scene_dict(), name, both_sides)


@lru_cache(MOST)
def _measured_bsdf(measured, variant, both_sides):
    return load_material(measured.scene_dict(), measured.name, both_sides)
