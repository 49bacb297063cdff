"""Turns what `render` is given into names, BSDF dictionaries and scenes of Mitsuba's."""

from typing import Any, TypeAlias

from brdfkit.errors import BrdfkitError
from brdfkit.fitting import Fit
from brdfkit.jit.llvm import use_variant
from brdfkit.materials import MaterialLike, material
from brdfkit.model import Model
from brdfkit.names import make_unique

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
    materials: dict[str, dict[str, Any]] = {}
    parameters: dict[str, dict[str, Any]] = {}
    for thing in things:
        name, bsdf, values = describe(thing)
        name = make_unique(name, materials)
        materials[name] = bsdf
        if values:
            parameters[name] = values
    return materials, parameters


def describe(thing):
    """(name, BSDF dictionary, parameters' values by name) of a thing to render."""
    if _is_pair(thing):
        return thing[0], *describe(thing[1])[1:]
    found = material(thing)
    values = found.values if isinstance(found, Model | Fit) else {}
    return str(found.name), found.scene_dict(), dict(values)
