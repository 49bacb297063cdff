"""Defines the search space of a fit: its shape parameters, with coordinates between their bounds.

A coordinate is 0 at the lower bound of its parameter and 1 at the upper one. It is logarithmic for
a parameter that is declared so. A point of a search is a vector of the coordinates of all searched
shape parameters, then the weights of the lobes in each channel.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.model import Model
from brdfkit.model.samples import Samples


def join_point(u: FloatArray, weights: FloatArray) -> FloatArray:
    """Join the parameters of points of a search to vectors (points, n).

    `u` (points, shapes): coordinates of shape parameters; `weights` (points, channels, lobes):
    weights of the lobes.
    """
    return np.concatenate([u, weights.reshape(len(u), math.prod(weights.shape[1:]))], axis=1)


def split_point(z: FloatArray, shapes: int, channels: int) -> tuple[FloatArray, FloatArray]:
    """Split vectors `z` (points, n) into coordinates and weights, the inverse of `join_point`."""
    lobes = (z.shape[1] - shapes) // channels
    return z[:, :shapes], z[:, shapes:].reshape(len(z), channels, lobes)


def make_point_limits(
    shapes: int, channels: int, weight_limits: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the lower and upper bounds (n,) of the vectors that `join_point` makes.

    `shapes`, `channels`: numbers of shape parameters and channels; `weight_limits` (2, lobes):
    lower and upper bounds of the weights.
    """
    low, high = (np.tile(limits, channels) for limits in weight_limits)
    return np.concatenate([np.zeros(shapes), low]), np.concatenate([np.ones(shapes), high])


def find_channel_entries(c: int, shapes: int, lobes: int) -> IntArray:
    """Return the indices of those entries of a point's vector that channel `c` depends on.

    These are all `shapes` coordinates of shape parameters, and the channel's own weights.
    """
    return np.r_[0:shapes, shapes + c * lobes : shapes + (c + 1) * lobes]


@dataclass(frozen=True)
class Space:
    """The search space of a fit: its n searched shape parameters with bounds, and fixed ones.

    `names`: names of the searched parameters (n,); `low`, `high`: their bounds (n,); `log`: whether
    the coordinate of each is logarithmic (n,); `fixed`: values of the other parameters by name.
    """

    names: tuple[str, ...]
    low: np.ndarray
    high: np.ndarray
    log: np.ndarray
    fixed: dict[str, float]

    @classmethod
    def for_model(
        cls,
        model: type[Model],
        bounds: Mapping[str, tuple[float, float]],
        fixed: Mapping[str, float],
        anisotropic: bool,
    ) -> Space:
        """Return the search space of the shape parameters of a `model` class that are not fixed.

        `bounds`: narrower bounds (low, high) by name; `fixed`: values by name; `anisotropic`:
        whether the second roughness of an anisotropic model is searched. Raises `BrdfkitError` for
        a name that is no searched parameter, and for bounds beyond the model's.
        """
        shapes = model.shapes(anisotropic)
        _check_bounds_and_fixed_values(model, shapes, bounds, fixed)
        names = tuple(name for name in shapes if name not in fixed)
        limits = [bounds.get(n, model.parameters[n].bounds) for n in names]
        low, high = np.array(limits).reshape(-1, 2).T
        log = np.array([model.parameters[n].log for n in names], bool)
        return cls(names, low, high, log, {k: float(v) for k, v in fixed.items()})

    @classmethod
    def for_samples(
        cls,
        samples: Samples,
        model: type[Model],
        bounds: Mapping[str, tuple[float, float]],
        fixed: Mapping[str, float],
        anisotropic: bool,
    ) -> Space:
        """Return the search space of a fit to `samples`, without parameters that they determine.

        The geometry of samples may determine parameters of the model, which become fixed unless
        they have `bounds`. The other arguments are those of `for_model`.
        """
        determined = {
            n: v for n, v in model.determine_parameters(samples).items() if n not in bounds
        }
        return cls.for_model(model, bounds, {**determined, **fixed}, anisotropic)

    def to_parameters(self, u: FloatArray) -> FloatArray:
        """Return the shape parameters (points, shapes) at coordinates `u` (points, shapes)."""
        linear = self.low + u * (self.high - self.low)
        return np.where(self.log, self._interpolate_logarithmically(u), linear)

    def to_named_values(self, u: FloatArray) -> dict[str, float]:
        """Return all shape parameters by name, fixed ones too, at coordinates `u` (shapes,)."""
        return dict(zip(self.names, map(float, self.to_parameters(u)), strict=True)) | self.fixed

    def to_coordinates(self, values: Mapping[str, Any]) -> FloatArray:
        """Return the coordinates (shapes,) of parameters given by name, clamped to [0, 1]."""
        x = np.array([values[name] for name in self.names])
        linear = (x - self.low) / (self.high - self.low)
        with np.errstate(divide="ignore", invalid="ignore"):
            log = np.log(x / self.low) / np.log(self.high / self.low)
        return np.clip(np.where(self.log, log, linear), 0, 1)

    def differentiate_parameters(self, u: FloatArray) -> FloatArray:
        """Return the parameters' derivatives with respect to their coordinates, at `u`."""
        with np.errstate(divide="ignore", invalid="ignore"):
            log = self._interpolate_logarithmically(u) * np.log(self.high / self.low)
        return np.where(self.log, log, self.high - self.low)

    def _interpolate_logarithmically(self, u: FloatArray) -> FloatArray:
        """Return the parameters at coordinates `u`, with all coordinates taken as logarithmic."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.low * (self.high / self.low) ** u


def _check_bounds_and_fixed_values(
    model: type[Model],
    shapes: Sequence[str],
    bounds: Mapping[str, tuple[float, float]],
    fixed: Mapping[str, float],
) -> None:
    """Raise `BrdfkitError` for bounds or fixed values of shape parameters that are invalid."""
    for name in (*bounds, *fixed):
        if name not in shapes:
            model.parameter(name)
            raise BrdfkitError(
                f"{model.type_name()}: {name} is not searched, so it can be neither bounded "
                f"nor fixed; searched are {', '.join(shapes) or 'none'}."
            )
    if both := set(bounds) & set(fixed):
        raise BrdfkitError(f"{model.type_name()}: {both.pop()} is bounded and fixed; choose one.")
    for name, (low, high) in bounds.items():
        allowed = model.parameters[name].bounds
        if low >= high:
            raise BrdfkitError(
                f"{model.type_name()}: the bounds of {name}, {low:g} and {high:g}, should be a low "
                f"and a higher value within {allowed[0]:g}..{allowed[1]:g}."
            )
        if not allowed[0] <= low < high <= allowed[1]:
            raise BrdfkitError(
                f"{model.type_name()}: the bounds {low:g}..{high:g} of {name} should lie "
                f"within {allowed[0]:g}..{allowed[1]:g}."
            )
    if unknown := [name for name, value in fixed.items() if value is None]:
        raise BrdfkitError(f"{model.type_name()}: {unknown[0]} is fixed at None; give a number.")
    model(**fixed)  # raises for values beyond the bounds
