"""Reads and writes the entries of a scene that `mitsuba.traverse` lists, and finds their bounds.

In this file `parameters` is always the object that `mitsuba.traverse` returns, and `key` is the
name of an entry in it.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.inverse.scenes.problem.places import find_place
from brdfkit.inverse.scenes.problem.tensors import (
    find_independent_shape,
    index_numbers_by_texel,
    is_environment_map,
    is_tensor,
    make_tensor,
)
from brdfkit.model import Model

# Default bounds of roughnesses; random samples hardly ever hit a narrower lobe
ROUGHNESS_BOUNDS = 0.001, 1.0
SHARE_BOUNDS = 0.0, 1.0
MITSUBA_BOUNDS = {
    **dict.fromkeys(("alpha", "alpha_u", "alpha_v", "roughness"), ROUGHNESS_BOUNDS),
    # These are parameters of the plugins blendbsdf and mask
    **dict.fromkeys(("weight", "opacity"), SHARE_BOUNDS),
    # These are parameters of the plugins principled and principledthin
    **dict.fromkeys(("anisotropic", "clearcoat", "clearcoat_gloss", "flatness"), SHARE_BOUNDS),
    **dict.fromkeys(("metallic", "sheen", "sheen_tint", "spec_tint"), SHARE_BOUNDS),
    **dict.fromkeys(("spec_trans", "specular"), SHARE_BOUNDS),
}
# Class of a BSDF → its parameters for which Mitsuba's derivatives of pictures are wrong: 0.5 to 1.1
# times the true ones
WRONG_DERIVATIVES = {"RoughPlastic": ("alpha", "eta"), "SmoothPlastic": ("diffuse_reflectance",)}


def find_searchable_entries(parameters: MitsubaObject) -> dict[str, str]:
    """Return the keys of numbers, colours, vectors, tensors and lamps' places, by short name."""
    return {
        shorten_key(key): key
        for key in parameters.properties
        if read_entry_numbers(parameters[key]) is not None
        or is_tensor(parameters[key])
        or find_place(parameters, key)
    }


def find_owner_model(parameters: MitsubaObject, key: str) -> tuple[type[Model] | None, str, str]:
    """Return the brdfkit model that an entry belongs to, and the names of BSDF and parameter.

    The model is None, and the BSDF's name empty, for entries that belong to no brdfkit model.
    """
    *path, parameter = shorten_key(key).removesuffix(".data").split(".")
    texture = parameters.properties[key][2]
    parent = parameters.hierarchy.get(texture, (None, 0))[0]
    model = getattr(parent, "model", None)
    if model is None or parameter not in model.parameters:
        return None, "", parameter
    return model, ".".join(path), parameter


def read_entry_numbers(value: MitsubaObject) -> FloatArray | None:
    """Return the numbers (n,) of a scene entry with up to four numbers; None for other entries."""
    import drjit as dr

    if isinstance(value, bool) or not (dr.is_array_v(value) and dr.is_float_v(value)):
        return None
    numbers = np.array(value, float).ravel()
    is_vector = type(value).__name__.startswith(("Float", "Color", "Vector", "Point"))
    return numbers if is_vector and len(numbers) <= 4 else None


def shorten_key(key: str) -> str:
    """Return an entry's key without the ".value" at its end, which may occur twice."""
    while key.endswith(".value"):
        key = key.removesuffix(".value")
    return key


def read_model_values(
    parameters: MitsubaObject, owner: str, model: type[Model]
) -> dict[str, Any] | None:
    """Return the values of all parameters of the BSDF `owner`, a brdfkit `model`, by name.

    Returns None where one of the parameters is a texture.
    """
    known, values = find_searchable_entries(parameters), {}
    for name, declared in model.parameters.items():
        key = known.get(f"{owner}.{name}")
        numbers = None if key is None else read_entry_numbers(parameters[key])
        if numbers is not None:
            values[name] = tuple(map(float, numbers)) if len(numbers) > 1 else float(numbers[0])
        elif key is not None or not declared.follows:
            return None
    return values


def write_scene_values(scene: MitsubaObject, values: Mapping[str, Any]) -> None:
    """Write `values`, by the short names of their entries, into a Mitsuba scene."""
    import mitsuba as mi

    parameters = mi.traverse(scene)
    known = find_searchable_entries(parameters)
    for name, value in values.items():
        if name not in known:
            raise no_such_error("parameter", name, known)
        parameters[known[name]] = _convert_to_entry_type(parameters, known[name], value)
    parameters.update()


def _convert_to_entry_type(parameters: MitsubaObject, key: str, value: Any) -> MitsubaObject:
    """Convert a float, a tuple or an array to the Mitsuba type of the entry `key`."""
    kind = type(parameters[key])
    if place := find_place(parameters, key):
        return place.make_transform(np.array(value))
    if not isinstance(value, np.ndarray):
        return kind(*value) if isinstance(value, tuple) else kind(value)
    texels = index_numbers_by_texel(parameters, key)
    shape = find_independent_shape(texels, is_environment_map(parameters, key))
    if shape != value.shape:
        raise BrdfkitError(f"{key}: it has the shape {shape}, and its values {value.shape}.")
    return make_tensor(value, texels)


def find_default_bounds(
    parameters: MitsubaObject, key: str, otherwise: tuple[float, float]
) -> tuple[float, float]:
    """Return the default bounds (low, high) of an entry, or `otherwise` if none are known.

    They are known for parameters of Mitsuba's own BSDFs that lie between 0 and 1.
    """
    owner, name = _find_mitsuba_bsdf(parameters, key)
    return MITSUBA_BOUNDS.get(name, otherwise) if owner else otherwise


def has_wrong_derivatives(parameters: MitsubaObject, key: str) -> bool:
    """Return whether Mitsuba's derivatives with respect to an entry are known to be wrong."""
    owner, name = _find_mitsuba_bsdf(parameters, key)
    return name in WRONG_DERIVATIVES.get(owner, ())


def _find_mitsuba_bsdf(parameters: MitsubaObject, key: str) -> tuple[str, str]:
    """Return the class of the Mitsuba BSDF that an entry belongs to, and the parameter's name.

    The class is "" for entries that belong to something else, such as a light or a brdfkit model.
    """
    import mitsuba as mi

    path = key.split(".")
    owner = parameters.properties[key][2]
    if path[-1] in ("value", "data"):  # the entry belongs to a texture of the BSDF
        owner, path = parameters.hierarchy.get(owner, (None, 0))[0], path[:-1]
    is_bsdf = isinstance(owner, mi.BSDF) and type(owner).__module__ == "mitsuba"
    return (owner.class_name(), path[-1]) if is_bsdf else ("", path[-1])
