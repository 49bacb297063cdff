"""Keeps measured materials and their BSDFs in memory, so that later previews start sooner."""

from functools import lru_cache
from pathlib import Path
from typing import Any

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.loading import locate_material
from brdfkit.materials.measured import Measured
from brdfkit.materials.resolve import Material, to_material
from brdfkit.rendering.scene_input.material import load_material

MATERIALS = 8  # largest number of materials in memory; a table of MERL's size takes 50 MB


def load_through_cache(renderable: Any) -> Any:
    """Replace the name or path of a material file by the material, from memory if possible.

    If the file has changed, it is read again. Anything else that `render` takes is returned
    unchanged.
    """
    if isinstance(renderable, tuple):
        return *renderable[:-1], load_through_cache(renderable[-1])
    if not isinstance(renderable, str | Path):
        return renderable
    try:
        path, _ = locate_material(renderable)
        status = path.stat()
    except (BrdfkitError, OSError, ValueError):
        return renderable  # a model's name, or a wrong path, which the reader reports better
    return _load_material_file(str(renderable), path.absolute(), status.st_mtime_ns, status.st_size)


@lru_cache(MATERIALS)
def _load_material_file(name: str, path: Path, changed: int, size: int) -> Material:
    """Load the material `name`; path, time of change and size of its file only key the cache."""
    return to_material(name)


def load_bsdf(material: Material, name: str, variant: str, both_sides: bool) -> MitsubaObject:
    """Load the BSDF of a material in the current `variant` of Mitsuba, see `load_material`.

    The BSDF of a `Measured` is kept in memory, because preparing its table takes long.
    """
    if isinstance(material, Measured):
        return _load_measured_bsdf(material, variant, both_sides)
    return load_material(material.scene_dict(), name, both_sides)


@lru_cache(MATERIALS)
def _load_measured_bsdf(measured: Measured, variant: str, both_sides: bool) -> MitsubaObject:
    """Load the BSDF of a measured material; the `variant` only keys the cache."""
    return load_material(measured.scene_dict(), measured.name, both_sides)
