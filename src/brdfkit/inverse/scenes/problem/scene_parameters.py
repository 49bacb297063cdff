"""The entries of a scene, what `mitsuba.traverse` names: those that may be searched, what they
hold, and whose they are."""

import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.inverse.scenes.problem.tensors import is_tensor, places, shape_of, tensor_of, wraps


def searchable(parameters):
    """The keys of all numbers, colours, vectors and tensors of a scene, by name."""
    return {
        short(key): key
        for key in keys(parameters)
        if numbers(parameters[key]) is not None or is_tensor(parameters[key])
    }


def model_of(parameters, key):
    """(model's class, name of the BSDF, name of the parameter) of an entry; None of others."""
    *path, parameter = short(key).removesuffix(".data").split(".")
    texture = parameters.properties[key][2]
    parent = parameters.hierarchy.get(texture, (None, 0))[0]
    model = getattr(parent, "model", None)
    if model is None or parameter not in model.parameters:
        return None, "", parameter
    return model, ".".join(path), parameter


def numbers(value):
    """The numbers (n,) of an entry's value; None where it holds none, or thousands."""
    import drjit as dr

    if isinstance(value, bool) or not (dr.is_array_v(value) and dr.is_float_v(value)):
        return None
    held = np.array(value, float).ravel()
    vector = type(value).__name__.startswith(("Float", "Color", "Vector", "Point"))
    return held if vector and len(held) <= 4 else None


def keys(parameters):
    """The names that `mitsuba.traverse` found."""
    return list(parameters.keys())


def short(key):
    """A name without ".value" at its end, of which there may be two."""
    while key.endswith(".value"):
        key = key.removesuffix(".value")
    return key


def numbers_in(parameters, owner, model):
    """The values of all parameters of a `model`, the BSDF `owner`, by name; None where one of them
    is a texture."""
    known, found = searchable(parameters), {}
    for name, declared in model.parameters.items():
        key = known.get(f"{owner}.{name}")
        if key is None:
            if declared.follows:
                continue
            return None
        held = numbers(parameters[key])
        found[name] = tuple(map(float, held)) if len(held) > 1 else float(held[0])
    return found


def put_values(scene, values):
    """Put `values`, by the names of `Unknown`s, into a scene of Mitsuba's."""
    import mitsuba as mi

    parameters = mi.traverse(scene)
    known = searchable(parameters)
    for name, value in values.items():
        if name not in known:
            raise no_such("parameter", name, known)
        parameters[known[name]] = _entry(parameters, known[name], value)
    parameters.update()


def _entry(parameters, key, value):
    """A value as the entry `key` of a scene."""
    kind = type(parameters[key])
    if not isinstance(value, np.ndarray):
        return kind(*value) if isinstance(value, tuple) else kind(value)
    at = places(parameters, key)
    shape = shape_of(at, wraps(parameters, key))
    if shape != value.shape:
        raise BrdfkitError(f"{key}: it has the shape {shape}, and its values {value.shape}.")
    return tensor_of(value, at)
