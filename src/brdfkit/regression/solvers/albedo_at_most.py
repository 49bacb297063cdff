"""Defines `AlbedoAtMost`, a constraint of fits on the share of light that the model reflects."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.arguments import to_positive_number
from brdfkit.core.array_types import FloatArray, IntArray, JitFloat
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.quadrature import make_ring_rule
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import Vector
from brdfkit.regression.problem.expansion import make_derivative_matrix
from brdfkit.regression.problem.not_finite import require_finite_lobes
from brdfkit.regression.problem.parameter_space import find_channel_entries
from brdfkit.regression.problem.problem import Problem

# Albedos are sums over this many points on each of twice as many rings, and exact to 1e-7
POINTS = 128

Angles: TypeAlias = tuple[float, ...]


@dataclass(frozen=True)
class AlbedoAtMost:
    """A constraint of a fit: the model reflects at most a share of the light that arrives.

    Parameters
    ----------
    limit : float, default 1
        The largest directional albedo of each channel, above 0. With 1, no more light leaves than
        arrives.
    theta : tuple of float, default (0, 30, 60, 75, 85, 89)
        Angles of incidence to the normal [degrees, from 0 to below 90] at which the constraint is
        met. Beyond the largest one it may be violated, because the formulas of `ward` and
        `ward_duer` grow without bound there.
    phi : tuple of float, default (0,)
        Azimuths of incidence [degrees], each with every `theta`; isotropic models need one.

    Examples
    --------
    >>> fit("paint.binary", "ward", constraints=[AlbedoAtMost(1.0)])    # doctest: +SKIP
    """

    limit: float = 1.0
    theta: Angles = (0.0, 30.0, 60.0, 75.0, 85.0, 89.0)
    phi: tuple[float, ...] = (0.0,)

    def __post_init__(self) -> None:
        object.__setattr__(self, "limit", to_positive_number("AlbedoAtMost: limit", self.limit))
        object.__setattr__(self, "theta", _check_angles("theta", self.theta, 0, 90))
        object.__setattr__(self, "phi", _check_angles("phi", self.phi, -np.inf, np.inf))

    def values(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the limit less the albedo for each incident direction and channel, (m,).

        The constraint is met where the values are at least 0. `u` (1, shapes): coordinates of the
        shape parameters; `weights` (1, channels, lobes): weights of the lobes.
        """
        values = []
        for rule, T in self._iterate_quadratures(problem, problem.columns.evaluate_values, u):
            # A model with negative weights is clamped at 0, in the loss as well
            values.append(self.limit - np.maximum(_evaluate_model(problem, weights, T), 0) @ rule)
        return np.concatenate(values)

    def slopes(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the derivatives (m, n) of `values` by the n coordinates and weights."""
        change = make_derivative_matrix(
            problem.columns, weights, problem.space.differentiate_parameters(u)
        )[0]
        shapes, (channels, lobes) = u.shape[1], weights.shape[1:]
        slopes = []
        for rule, T in self._iterate_quadratures(problem, problem.columns.evaluate, u):
            for c, model in enumerate(_evaluate_model(problem, weights, T)):
                slope = np.zeros(shapes + channels * lobes)
                slope[find_channel_entries(c, shapes, lobes)] = -change[c] @ (
                    T @ (rule * (model >= 0))
                )
                slopes.append(slope)
        return np.array(slopes)

    def describe(self, rows: IntArray, channels: int) -> str:
        """Return in words which albedos the values with the indices `rows` limit."""
        angles = np.repeat(self.theta, len(self.phi))[rows // channels]
        return f"the albedo at {', '.join(dict.fromkeys(f'{angle:g}°' for angle in angles))}"

    def _iterate_quadratures(
        self, problem: Problem, evaluate: Callable[..., list[JitFloat]], u: FloatArray
    ) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Yield the weights (n,) of a quadrature and the model's columns, for each direction.

        The product of both is the directional albedo of each lobe for the incident direction.
        `evaluate`: a method of `Columns` that returns columns, each an array (n,).
        """
        wi, wo, rules = _place_quadrature_nodes(self.theta, self.phi)
        shapes = [
            double_precision.to_array(np.full(len(wi.z), x))
            for x in problem.space.to_parameters(u)[0]
        ]
        T = np.stack([np.asarray(column) for column in evaluate(shapes, wi, wo)])
        values = len(problem.columns.lobes)
        require_finite_lobes(problem.model, T[: problem.columns.lobes.max() + 1], wi, wo)
        # Dr.Jit's forward mode returns NaN for the derivative of 0^p by p, which is 0
        T[values:] = np.nan_to_num(T[values:], posinf=0, neginf=0)
        ends = np.cumsum([len(rule) for rule in rules])
        yield from zip(rules, np.split(T, ends[:-1], axis=1), strict=True)


@lru_cache(maxsize=4)
def _place_quadrature_nodes(
    theta: tuple[float, ...], phi: tuple[float, ...]
) -> tuple[Vector, Vector, tuple[FloatArray, ...]]:
    """Return the nodes of the quadratures over outgoing directions, for all incident directions.

    `theta`, `phi`: angles of incidence [degrees]. The result is (wi, wo, weights): the directions
    of all nodes, and an array of weights (n,) for each incident direction.
    """
    angles = np.meshgrid(np.radians(theta), np.radians(phi), indexing="ij")
    incident = from_angles(*angles).reshape(-1, 3)
    nodes, rules = zip(*(make_ring_rule(wi, POINTS) for wi in incident), strict=True)
    wi = np.repeat(incident, [len(rule) for rule in rules], axis=0)
    return double_precision.to_vector(wi), double_precision.to_vector(np.concatenate(nodes)), rules


def _evaluate_model(problem: Problem, weights: FloatArray, T: FloatArray) -> FloatArray:
    """Return the model's BRDF (channels, n) from its columns (columns, n), not clamped at 0."""
    columns = problem.columns
    factors = (weights[0][:, columns.lobes]) ** columns.powers
    return factors @ T[: len(columns.lobes)]


def _check_angles(name: str, given: Any, low: float, high: float) -> tuple[float, ...]:
    """Return one or several angles [degrees] as a tuple of floats.

    Raises `BrdfkitError` unless they are from `low` to below `high`; `name`: name of the argument.
    """
    try:
        angles = tuple(map(float, given if isinstance(given, Iterable) else [given]))
    except (TypeError, ValueError):
        angles = ()
    if not angles or not all(low <= angle < high for angle in angles):
        limits = f" from {low} to below {high}" if np.isfinite(low) else ""
        raise BrdfkitError(
            f"AlbedoAtMost: {name} = {given!r} should be one or several angles{limits} [degrees]."
        )
    return angles
