"""Turns what `render` is given into names, BSDF dictionaries and scenes of Mitsuba's."""

from typing import Any, TypeAlias

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.names import make_unique
from brdfkit.materials.resolve import Material, MaterialLike, to_material
from brdfkit.model import Model
from brdfkit.regression import Fit
from brdfkit.volumes import Volume

Renderable: TypeAlias = MaterialLike | tuple[str, MaterialLike]


def mitsuba():
    """The module `mitsuba`, with a variant set."""
    import mitsuba as mi

    use_variant()
    return mi


def as_list(things: Any) -> list[Renderable]:
    """One thing to render or several, as a list; at least one."""
    alone = _is_pair(things) or isinstance(things, dict | str) or not hasattr(things, "__iter__")
    found = [things] if alone else list(things)
    if not found:
        raise BrdfkitError("There is nothing to render; give at least one material.")
    return found


def _is_pair(thing):
    """Whether `thing` is a pair of a name and a material."""
    return isinstance(thing, tuple) and len(thing) == 2 and isinstance(thing[0], str)


def describe_all(things):
    """(BSDF dictionaries, parameters' values) of things to render, each by a name of its own."""
    materials = name_all(things)
    entries = {name: found.scene_dict() for name, found in materials.items()}
    return entries, parameters_of(materials)


def name_all(things: list[Renderable]) -> dict[str, Material]:
    """The materials that things to render are, each by a name of its own."""
    materials: dict[str, Material] = {}
    for name, found in map(identify, things):
        materials[make_unique(name, materials)] = found
    return materials


def parameters_of(materials: dict[str, Material]) -> dict[str, dict[str, Any]]:
    """The parameters' values of the `materials` that have any, by their names."""
    models = {name: found for name, found in materials.items() if isinstance(found, Model | Fit)}
    return {name: dict(found.values) for name, found in models.items() if found.values}


def identify(thing: Any) -> tuple[str, Material]:
    """(name, material) of a thing to render."""
    if isinstance(thing, Volume):
        raise BrdfkitError(f"{thing.name} is a volume, not a material: call render_volume.")
    if _is_pair(thing):
        return thing[0], identify(thing[1])[1]
    found = to_material(thing)
    return str(found.name), found
