"""`AlbedoAtMost`: a constraint on the share of light that the model reflects."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from brdfkit.core.arguments import to_positive
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.quadrature import make_ring_rule
from brdfkit.core.jit import double_precision
from brdfkit.regression.problem.expansion import combine
from brdfkit.regression.problem.not_finite import require_finite
from brdfkit.regression.problem.parameter_space import of_channel

# Half the rings of a quadrature, and the points on each: albedos are exact to 1e-7
POINTS = 128

Angles: TypeAlias = tuple[float, ...]


@dataclass(frozen=True)
class AlbedoAtMost:
    """A constraint: of the light from some directions the model reflects at most a share.

    Parameters
    ----------
    limit : float, default 1
        The largest directional albedo of each channel, above 0; at most 1 where no light is gained.
    theta : tuple of float, default (0, 30, 60, 75, 85, 89)
        Angles of incidence to the normal [degrees, from 0 to below 90]. Nothing is held beyond the
        last of them, where the formulas of `ward` and `ward_duer` grow without bound.
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
        object.__setattr__(self, "limit", to_positive("AlbedoAtMost: limit", self.limit))
        object.__setattr__(self, "theta", _to_angles("theta", self.theta, 0, 90))
        object.__setattr__(self, "phi", _to_angles("phi", self.phi, -np.inf, np.inf))

    def values(self, problem, u, weights):
        """The values (m,) at a point, not negative where the constraint is met: by directions, then
        channels."""
        found = []
        for rule, T in self._integrate(problem, problem.columns.values, u):
            # A model with negative weights is clamped at 0
            found.append(self.limit - np.maximum(_mix(problem, weights, T), 0) @ rule)
        return np.concatenate(found)

    def slopes(self, problem, u, weights):
        """Their derivatives (m, n) by coordinates, then by weights."""
        change = combine(problem.columns, weights, problem.space.slopes(u))[0]
        shapes, (channels, lobes) = u.shape[1], weights.shape[1:]
        slopes = []
        for rule, T in self._integrate(problem, problem.columns.eval, u):
            for c, model in enumerate(_mix(problem, weights, T)):
                slope = np.zeros(shapes + channels * lobes)
                slope[of_channel(c, shapes, lobes)] = -change[c] @ (T @ (rule * (model >= 0)))
                slopes.append(slope)
        return np.array(slopes)

    def describe(self, rows, channels):
        """What the values of these numbers limit, in words."""
        angles = np.repeat(self.theta, len(self.phi))[rows // channels]
        return f"the albedo at {', '.join(dict.fromkeys(f'{angle:g}°' for angle in angles))}"

    def _integrate(self, problem, evaluate, u):
        """Yield for each direction of incidence the weights (n,) of the quadrature's nodes, and the
        columns (columns, n) that `evaluate` gives there."""
        wi, wo, rules = _place_nodes(self.theta, self.phi)
        shapes = [
            double_precision.to_array(np.full(len(wi.z), x)) for x in problem.space.table(u)[0]
        ]
        T = np.stack([np.asarray(column) for column in evaluate(shapes, wi, wo)])
        values = len(problem.columns.lobes)
        require_finite(problem.model, T[: problem.columns.lobes.max() + 1], wi, wo)
        # Forwards, Dr.Jit has NaN where 0^p has a slope of 0 by p
        T[values:] = np.nan_to_num(T[values:], posinf=0, neginf=0)
        ends = np.cumsum([len(rule) for rule in rules])
        yield from zip(rules, np.split(T, ends[:-1], axis=1), strict=True)


@lru_cache(maxsize=4)
def _place_nodes(theta, phi):
    """wi and wo, `double_precision.Vector`, of the quadratures for all directions of incidence, and
    the weights (n,) of the nodes of each."""
    angles = np.meshgrid(np.radians(theta), np.radians(phi), indexing="ij")
    incident = from_angles(*angles).reshape(-1, 3)
    nodes, rules = zip(*(make_ring_rule(wi, POINTS) for wi in incident), strict=True)
    wi = np.repeat(incident, [len(rule) for rule in rules], axis=0)
    return double_precision.to_vector(wi), double_precision.to_vector(np.concatenate(nodes)), rules


def _mix(problem, weights, T):
    """The model (channels, n), not clamped, of its columns (columns, n)."""
    columns = problem.columns
    factors = (weights[0][:, columns.lobes]) ** columns.powers
    return factors @ T[: len(columns.lobes)]


def _to_angles(name, given, low, high):
    """One or several angles [degrees], from `low` to below `high`, as a tuple of floats."""
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
