"""The numbers that are searched: which entries of a scene they are, and within which bounds."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.errors import BrdfkitError, no_such
from brdfkit.refining.tensors import is_tensor, numbers_of, places, shape_of, tensor_of, wraps

MOST = 32  # numbers; for each of them a picture of derivatives is rendered


@dataclass(frozen=True)
class Unknown:
    """An entry of a scene that is searched.

    key : its name in `mitsuba.traverse`.
    name : the same, without a `.value` at its end.
    owner : the name of the BSDF whose parameter it is; empty of others.
    parameter : the name of the parameter within its owner.
    model : the class of brdfkit's model whose parameter it is, or None.
    start : its numbers (n,) where the search begins.
    colour : whether each number changes one channel of pictures alone.
    linear : whether pictures of direct light are linear in it.
    low, high : its bounds; coordinates are the values themselves unless both are finite.
    log : whether steps are relative.
    shape : of a tensor's numbers; empty of others.
    places : which number each of its texels shows; None of others.
    around : whether its columns go around.
    """

    key: str
    name: str
    owner: str
    parameter: str
    model: Any
    start: np.ndarray
    colour: bool
    linear: bool
    low: float
    high: float
    log: bool
    shape: tuple[int, ...] = ()
    places: Any = None
    around: bool = False

    @property
    def names(self):
        """A name for each number."""
        if len(self.start) == 1:
            return (self.name,)
        return tuple(f"{self.name}[{i}]" for i in range(len(self.start)))

    def table(self, u):
        """Values at coordinates `u`, which go from 0 to 1 between finite bounds."""
        if self.log:
            return self.low * (self.high / self.low) ** u
        return self.low + u * (self.high - self.low) if self.bounded else np.array(u)

    def coordinates(self, values):
        """The coordinates of values; the inverse of `table`."""
        values = np.asarray(values)
        if self.log:
            return np.log(values / self.low) / np.log(self.high / self.low)
        return (values - self.low) / (self.high - self.low) if self.bounded else values

    def slopes(self, u):
        """The derivatives of the values by their coordinates."""
        if self.log:
            return self.table(u) * np.log(self.high / self.low)
        return np.full_like(u, self.high - self.low if self.bounded else 1.0)

    def gathered(self, slopes):
        """Derivatives (n,) by the numbers, of those by the entry's, which may repeat some."""
        if self.places is None:
            return slopes
        return np.bincount(self.places.ravel(), weights=slopes, minlength=len(self.start))

    @property
    def bounded(self):
        """Whether both bounds are finite."""
        return bool(np.isfinite(self.high - self.low))

    @property
    def limits(self):
        """The least and the largest coordinate."""
        return (0.0, 1.0) if self.bounded else (self.low, self.high)


def choose(parameters, asked):
    """The `Unknown`s among the `parameters`, what `mitsuba.traverse` says of a scene.

    `asked`: names, or a dictionary of names with bounds (low, high), None for the usual ones; None
    for all numbers of brdfkit's models. Raises `BrdfkitError` for a name that is none, one that
    holds no numbers, for bounds that are none, and where nothing is left to search.
    """
    if isinstance(asked, str):
        asked = [asked]
    bounds = dict(asked) if isinstance(asked, Mapping) else dict.fromkeys(asked or ())
    known = searchable(parameters)
    if asked is None:
        numbers = {name: key for name, key in known.items() if not is_tensor(parameters[key])}
        bounds = {name: None for name, key in numbers.items() if _model_of(parameters, key)[0]}
        if not bounds:
            raise BrdfkitError(
                "the scene has no number of a brdfkit model to search; name its parameters, "
                "as mitsuba.traverse does."
            )
    for name in bounds:
        if name in keys(parameters) and _short(name) not in known:
            kind = type(parameters[name]).__name__
            raise BrdfkitError(
                f"{name}: what it holds ({kind}) is not searched; numbers, colours, vectors and "
                "textures that Mitsuba differentiates are."
            )
        if _short(name) not in known:
            raise no_such("parameter", name, known, "the scene")
    if not bounds:
        raise BrdfkitError("parameters is empty; name some, as mitsuba.traverse does.")
    once = {known[_short(name)]: limits for name, limits in bounds.items()}
    return [_unknown(parameters, key, limits) for key, limits in once.items()]


def searchable(parameters):
    """The keys of all numbers, colours, vectors and tensors of a scene, by name."""
    return {
        _short(key): key
        for key in keys(parameters)
        if _numbers(parameters[key]) is not None or is_tensor(parameters[key])
    }


def _unknown(parameters, key, limits):
    """The `Unknown` of an entry, within the `limits`, None for the usual ones."""
    value, (model, owner, parameter) = parameters[key], _model_of(parameters, key)
    tensor, colour = is_tensor(value), type(value).__name__.startswith("Color")
    at = places(parameters, key) if tensor else None
    start = numbers_of(value, at) if tensor else _numbers(value)
    low = -np.inf if type(value).__name__.startswith(("Point", "Vector")) else 0.0
    high, log, linear = np.inf, False, colour
    if model:
        declared = model.parameters[parameter]
        (low, high), log, linear = declared.bounds, declared.log, declared.linear
    if limits is not None:
        low, high = _checked(key, limits, low if model else -np.inf, high)
    elif (start < low).any():
        raise BrdfkitError(f"{key}: it begins below 0; give its bounds, as {{name: (low, high)}}.")
    start = np.clip(start, low, high)
    around = tensor and wraps(parameters, key)
    shape = shape_of(at, around) if tensor else ()
    return Unknown(
        key,
        _short(key),
        owner,
        parameter,
        model,
        start,
        colour,
        linear,
        low,
        high,
        log,
        shape,
        at,
        around,
    )


def _checked(key, limits, least, most):
    try:
        low, high = map(float, limits)
    except (TypeError, ValueError):
        raise BrdfkitError(f"{key}: its bounds {limits!r} should be (low, high).") from None
    if not least <= low < high <= most:
        raise BrdfkitError(
            f"{key}: the bounds {low:g} and {high:g} should be a low and a higher value within "
            f"{least:g}..{most:g}."
        )
    return low, high


def _model_of(parameters, key):
    """(model's class, name of the BSDF, name of the parameter) of an entry; None of others."""
    *path, parameter = _short(key).removesuffix(".data").split(".")
    texture = parameters.properties[key][2]
    parent = parameters.hierarchy.get(texture, (None, 0))[0]
    model = getattr(parent, "model", None)
    if model is None or parameter not in model.parameters:
        return None, "", parameter
    return model, ".".join(path), parameter


def _numbers(value):
    """The numbers (n,) of an entry's value; None where it holds none, or thousands."""
    import drjit as dr

    if isinstance(value, bool) or not (dr.is_array_v(value) and dr.is_float_v(value)):
        return None
    numbers = np.array(value, float).ravel()
    vector = type(value).__name__.startswith(("Float", "Color", "Vector", "Point"))
    return numbers if vector and len(numbers) <= 4 else None


def keys(parameters):
    """The names that `mitsuba.traverse` found."""
    return list(parameters.keys())


def _short(key):
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
        numbers = _numbers(parameters[key])
        found[name] = tuple(map(float, numbers)) if len(numbers) > 1 else float(numbers[0])
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
