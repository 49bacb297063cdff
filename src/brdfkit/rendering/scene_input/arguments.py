"""Converts the materials that `render` receives to names, BSDF dictionaries and parameters."""

from typing import Any, TypeAlias

from brdfkit.core.array_types import MitsubaModule
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.llvm import use_variant
from brdfkit.materials.measured.evidence import make_name_unique
from brdfkit.materials.resolve import Material, MaterialLike, to_material
from brdfkit.model import Model
from brdfkit.regression import Fit
from brdfkit.volumes import Volume

Renderable: TypeAlias = MaterialLike | tuple[str, MaterialLike]


def load_mitsuba() -> MitsubaModule:
    """Import `mitsuba`, set the best variant unless one is set, and return the module."""
    import mitsuba as mi

    use_variant()
    return mi


def to_material_list(materials: Any) -> list[Renderable]:
    """Return one material or several as a list; raise `BrdfkitError` if there is none."""
    is_single = (
        _is_named_material(materials)
        or isinstance(materials, dict | str)
        or not hasattr(materials, "__iter__")
    )
    listed = [materials] if is_single else list(materials)
    if not listed:
        raise BrdfkitError("There is nothing to render; give at least one material.")
    return listed


def _is_named_material(material: Any) -> bool:
    """Return whether `material` is a pair of a name and a material."""
    return isinstance(material, tuple) and len(material) == 2 and isinstance(material[0], str)


def load_named_materials(renderables: list[Renderable]) -> dict[str, Material]:
    """Load materials, and return them by their names, which are made unique."""
    materials: dict[str, Material] = {}
    for name, material in map(to_named_material, renderables):
        materials[make_name_unique(name, material, materials)] = material
    return materials


def collect_parameters(materials: dict[str, Material]) -> dict[str, dict[str, Any]]:
    """Return the parameter values of the models and fits among the `materials`, by name."""
    models = {
        name: material for name, material in materials.items() if isinstance(material, Model | Fit)
    }
    return {name: dict(model.values) for name, model in models.items() if model.values}


def to_named_material(renderable: Any) -> tuple[str, Material]:
    """Return the name and the material of anything that `render` takes as a material.

    Raises `BrdfkitError` for a volume, and for anything that is no material.
    """
    if isinstance(renderable, Volume):
        raise BrdfkitError(f"{renderable.name} is a volume, not a material: call render_volume.")
    if _is_named_material(renderable):
        return renderable[0], to_named_material(renderable[1])[1]
    material = to_material(renderable)
    return str(material.name), material
