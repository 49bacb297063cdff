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

MATERIALS = 8  # largest number of materials in memory; one of the MERL database takes 50 MB


def load_material_through_cache(renderable: Any) -> Any:
    """Replace the name or path of a material file by the material, from memory if possible.

    If the file has changed, it is read again. Anything else that `render` takes is returned
    unchanged.
    """
    if isinstance(renderable, tuple):
        return *renderable[:-1], load_material_through_cache(renderable[-1])
    if not isinstance(renderable, str | Path):
        return renderable
    try:
        path, _ = locate_material(renderable)
        status = path.stat()
    except (BrdfkitError, OSError, ValueError):
        return renderable  # a model's name, or a wrong path, which the caller reports
    return _load_material_file(str(renderable), path.absolute(), status.st_mtime_ns, status.st_size)


@lru_cache(MATERIALS)
def _load_material_file(name: str, path: Path, changed: int, size: int) -> Material:
    """Load the material `name`, and keep it in memory.

    `path`, `changed` and `size` are the file's path, time of change [ns] and size. They are keys of
    the cache, so that a changed file is read again.
    """
    return to_material(name)


def load_bsdf(material: Material, name: str, variant: str, both_sides: bool) -> MitsubaObject:
    """Load the BSDF of a material in the current `variant` of Mitsuba.

    The BSDF of a `Measured` is kept in memory, because preparing its table takes long. Error
    messages use the `name`. With `both_sides` the material also reflects at the back of a surface.
    """
    if isinstance(material, Measured):
        return _load_measured_bsdf(material, variant, both_sides)
    return load_material(material.scene_dict(), name, both_sides)


@lru_cache(MATERIALS)
def _load_measured_bsdf(measured: Measured, variant: str, both_sides: bool) -> MitsubaObject:
    """Load the BSDF of a measured material, and keep it in memory.

    The `variant` of Mitsuba is a key of the cache, as a BSDF works only in the one that loaded it.
    """
    return load_material(measured.scene_dict(), measured.name, both_sides)
