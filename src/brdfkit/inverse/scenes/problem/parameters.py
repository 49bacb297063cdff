"""The numbers that are searched: which entries of a scene they are, and within which bounds."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.inverse.scenes.problem.parameter_facts import differentiated_wrongly, usual_bounds
from brdfkit.inverse.scenes.problem.scene_parameters import (
    keys,
    model_of,
    numbers,
    searchable,
    short,
)
from brdfkit.inverse.scenes.problem.tensors import is_tensor, numbers_of, places, shape_of, wraps

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
    wrongly : whether Mitsuba's derivatives of pictures by it are wrong.
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
    wrongly: bool = False

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
        single = {name: key for name, key in known.items() if not is_tensor(parameters[key])}
        bounds = {name: None for name, key in single.items() if model_of(parameters, key)[0]}
        if not bounds:
            raise BrdfkitError(
                "the scene has no number of a brdfkit model to search; name its parameters, "
                "as mitsuba.traverse does."
            )
    for name in bounds:
        if name in keys(parameters) and short(name) not in known:
            kind = type(parameters[name]).__name__
            raise BrdfkitError(
                f"{name}: what it holds ({kind}) is not searched; numbers, colours, vectors and "
                "textures that Mitsuba differentiates are."
            )
        if short(name) not in known:
            raise no_such("parameter", name, known, "the scene")
    if not bounds:
        raise BrdfkitError("parameters is empty; name some, as mitsuba.traverse does.")
    once = {known[short(name)]: limits for name, limits in bounds.items()}
    return [_unknown(parameters, key, limits) for key, limits in once.items()]


def _unknown(parameters, key, limits):
    """The `Unknown` of an entry, within the `limits`, None for the usual ones."""
    value, (model, owner, parameter) = parameters[key], model_of(parameters, key)
    tensor, colour = is_tensor(value), type(value).__name__.startswith("Color")
    at = places(parameters, key) if tensor else None
    start = numbers_of(value, at) if tensor else numbers(value)
    low = -np.inf if type(value).__name__.startswith(("Point", "Vector")) else 0.0
    high, log, linear = np.inf, False, colour
    if model:
        declared = model.parameters[parameter]
        (low, high), log, linear = declared.bounds, declared.log, declared.linear
    else:
        low, high = usual_bounds(parameters, key, (low, high))
        log = low > 0  # of a roughness
    if limits is not None:
        low, high = _checked(key, limits, *((low, high) if model else (-np.inf, np.inf)))
    elif (start < low).any():
        raise BrdfkitError(f"{key}: it begins below 0; give its bounds, as {{name: (low, high)}}.")
    start, log = np.clip(start, low, high), log and low > 0
    around = tensor and wraps(parameters, key)
    shape = shape_of(at, around) if tensor else ()
    return Unknown(
        key,
        short(key),
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
        differentiated_wrongly(parameters, key),
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
