"""Chooses which entries of a scene `refine` searches, and within which bounds."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number_pair
from brdfkit.core.array_types import AnyArray, FloatArray, IntArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.inverse.scenes.problem.places import Place, find_place, is_position_of_point_lamp
from brdfkit.inverse.scenes.problem.scene_parameters import (
    find_default_bounds,
    find_owner_model,
    find_searchable_entries,
    has_wrong_derivatives,
    read_entry_numbers,
    shorten_key,
)
from brdfkit.inverse.scenes.problem.tensors import (
    find_independent_shape,
    index_numbers_by_texel,
    is_environment_map,
    is_tensor,
    read_tensor,
)
from brdfkit.model import Model

# Largest number of values that Gauss-Newton steps search, as they render a picture of derivatives
# for each value
PARAMETER_LIMIT = 32

Bounds = tuple[float, float]


@dataclass(frozen=True)
class Unknown:
    """An entry of a scene that `refine` searches: a number, a colour or a tensor, as n numbers.

    The search works on coordinates of the numbers: between finite bounds these go from 0 to 1,
    otherwise they are the numbers themselves.

    key : the entry's name in `mitsuba.traverse`.
    name : the key without ".value" at its end.
    owner : the name of the brdfkit BSDF whose parameter the entry is, or "".
    parameter : the parameter's name within its owner.
    model : the class of the owner's model, or None.
    start : the numbers (n,) where the search begins.
    is_colour : whether each number changes only its own channel of the pictures.
    is_linear : whether pictures of direct light are linear in the numbers.
    low, high : the bounds of the values.
    is_log : whether coordinates are proportional to the logarithm of the values.
    shape : the shape of a tensor's numbers; () for other entries.
    texels : the index of the number that each texel of a tensor holds; None for other entries.
    wraps : whether the last column of a tensor is a neighbour of its first one.
    has_wrong_derivatives : whether Mitsuba's derivatives with respect to this entry are wrong.
    is_place : whether the numbers are the position of a lamp, or the direction of its light.
    place : what the numbers are within a lamp's `to_world`; None for other entries.
    """

    key: str
    name: str
    owner: str
    parameter: str
    model: type[Model] | None
    start: FloatArray
    is_colour: bool
    is_linear: bool
    low: float
    high: float
    is_log: bool
    shape: tuple[int, ...] = ()
    texels: IntArray | None = None
    wraps: bool = False
    has_wrong_derivatives: bool = False
    is_place: bool = False
    place: Place | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """A name for each number of the entry, such as "bsdf.alpha" or "bsdf.reflectance[0]"."""
        if len(self.start) == 1:
            return (self.name,)
        components = self.place.free if self.place else range(len(self.start))
        return tuple(f"{self.name}[{i}]" for i in components)

    def to_values(self, coordinates: FloatArray) -> FloatArray:
        """Return the numbers (n,) of the entry at their search coordinates."""
        if self.is_log:
            return self.low * (self.high / self.low) ** coordinates
        if self.is_bounded:
            return self.low + coordinates * (self.high - self.low)
        return np.array(coordinates)

    def to_coordinates(self, values: FloatArray) -> FloatArray:
        """Return the search coordinates (n,) of values; the inverse of `to_values`."""
        values = np.asarray(values)
        if self.is_log:
            return np.log(values / self.low) / np.log(self.high / self.low)
        return (values - self.low) / (self.high - self.low) if self.is_bounded else values

    def differentiate_values(self, coordinates: FloatArray) -> FloatArray:
        """Return the derivatives (n,) of the values with respect to their search coordinates."""
        if self.is_log:
            return self.to_values(coordinates) * np.log(self.high / self.low)
        return np.full_like(coordinates, self.high - self.low if self.is_bounded else 1.0)

    def sum_over_copies(self, derivatives: FloatArray) -> FloatArray:
        """Return a loss's derivatives with respect to the searched numbers (n,) of a tensor.

        `derivatives` are those with respect to all its texels. Some texels are copies that hold the
        same number, such as the last column of an environment map; their derivatives are added up.
        """
        if self.texels is None:
            return derivatives
        sums: AnyArray = np.bincount(self.texels.ravel(), derivatives, len(self.start))
        return sums

    def find_scale(self, sight: FloatArray | None) -> float:
        """Return how much a coordinate has to change for other pictures, for the place of a lamp.

        That is its distance from the point `sight` (3,) that the cameras see, or a radian for a
        direction; 1 for other entries.
        """
        if not self.is_place:
            return 1.0
        is_direction = self.place is not None and self.place.axis is not None
        away = 1.0 if is_direction or sight is None else float(np.linalg.norm(self.start - sight))
        return (away or 1.0) / (self.high - self.low if self.is_bounded else 1.0)

    @property
    def is_bounded(self) -> bool:
        """Whether both bounds of the values are finite."""
        return bool(np.isfinite(self.high - self.low))

    @property
    def limits(self) -> Bounds:
        """The lowest and the highest search coordinate of the entry's numbers."""
        return (0.0, 1.0) if self.is_bounded else (self.low, self.high)


def choose_unknowns(
    parameters: MitsubaObject, requested: str | Iterable[str] | Mapping[str, Bounds | None] | None
) -> list[Unknown]:
    """Return the entries of a scene that a user wants to be searched, as `Unknown`s.

    `parameters` is the result of `mitsuba.traverse` for the scene. `requested` holds names, or
    names with their bounds (low, high), where None stands for the default bounds; if it is None
    itself, all numbers of brdfkit's models are chosen. Raises `BrdfkitError` for unknown names, for
    entries that cannot be searched, for wrong bounds, and where nothing is left to search.
    """
    if isinstance(requested, str):
        requested = [requested]
    known = find_searchable_entries(parameters)
    if requested is None:
        single = {name: key for name, key in known.items() if not is_tensor(parameters[key])}
        requested = [name for name, key in single.items() if find_owner_model(parameters, key)[0]]
        if not requested:
            raise BrdfkitError(
                "the scene has no number of a brdfkit model to search; name its parameters, "
                "as mitsuba.traverse does."
            )
    bounds = dict(requested) if isinstance(requested, Mapping) else dict.fromkeys(requested, None)
    for name in bounds:
        if name in parameters and shorten_key(name) not in known:
            kind = type(parameters[name]).__name__
            raise BrdfkitError(
                f"{name}: its type {kind} cannot be searched; numbers, colours, vectors and "
                "textures that Mitsuba differentiates can."
            )
        if shorten_key(name) not in known:
            raise no_such_error("parameter", name, known, "the scene")
    if not bounds:
        raise BrdfkitError("parameters is empty; name some, as mitsuba.traverse does.")
    once = {known[shorten_key(name)]: limits for name, limits in bounds.items()}
    return [_make_unknown(parameters, key, limits) for key, limits in once.items()]


def _make_unknown(parameters: MitsubaObject, key: str, bounds: Bounds | None) -> Unknown:
    """Return the `Unknown` for the scene entry `key`; without `bounds` it has the default ones."""
    value, (model, owner, parameter) = parameters[key], find_owner_model(parameters, key)
    kind = type(value).__name__
    texels: IntArray | None = None
    shape: tuple[int, ...] = ()
    wraps = False
    place = find_place(parameters, key)
    is_place = place is not None or is_position_of_point_lamp(parameters, key)
    numbers = place.start if place else read_entry_numbers(value)
    if numbers is None:
        texels, wraps = index_numbers_by_texel(parameters, key), is_environment_map(parameters, key)
        shape, numbers = find_independent_shape(texels, wraps), read_tensor(value, texels)
    widest = -np.inf, np.inf
    if model:
        declared = model.parameters[parameter]
        low, high = widest = declared.bounds
        is_log, is_linear = declared.log, declared.linear
    else:
        low = -np.inf if place or kind.startswith(("Point", "Vector")) else 0.0
        low, high = find_default_bounds(parameters, key, (low, np.inf))
        # Only a roughness has a lower bound above 0; its logarithm is searched
        is_log, is_linear = low > 0, kind.startswith("Color")
    if bounds is not None:
        low, high = _check_bounds(key, bounds, *widest)
    elif (numbers < low).any():
        raise BrdfkitError(f"{key}: it begins below 0; give its bounds, as {{name: (low, high)}}.")
    return Unknown(
        key,
        shorten_key(key),
        owner,
        parameter,
        model,
        np.clip(numbers, low, high),
        kind.startswith("Color"),
        is_linear,
        low,
        high,
        is_log and low > 0,
        shape,
        texels,
        wraps,
        is_place or has_wrong_derivatives(parameters, key),
        is_place,
        place,
    )


def _check_bounds(key: str, value: Any, lowest: float, highest: float) -> Bounds:
    """Return a user's bounds (low, high), which must lie within `lowest` to `highest`."""
    low, high = to_number_pair(f"{key}: bounds", value)
    if not lowest <= low < high <= highest:
        raise BrdfkitError(
            f"{key}: the bounds {low:g} and {high:g} should be a low and a higher value within "
            f"{lowest:g}..{highest:g}."
        )
    return low, high
