"""Fits normals and weights of all pixels of a tile by damped Gauss-Newton steps of their own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitVector
from brdfkit.core.jit.double_precision import Vector, choose_float_type, to_array, to_vector
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.inverse.photographs.objects.equations import (
    Equations,
    Prior,
    Reflection,
    compute_equations,
)
from brdfkit.inverse.photographs.objects.frames import make_tangents, tilt
from brdfkit.inverse.photographs.objects.small_systems import compute_step
from brdfkit.inverse.photographs.objects.tile import Tile, to_numpy

DAMPING = 1e-2  # damping of the first step
BETTER, WORSE = 0.2, 6.0  # factors of the damping after a step that reduces the loss, or does not


@dataclass(frozen=True)
class Pixels:
    """What is fitted for n pixels.

    normals : unit normals (n, 3).
    weights : weights (n, channels, lobes) of the model's lobes.
    loss : the robust sums (n,) of squared residuals.
    lights : the numbers (n,) of photographs that count.
    """

    normals: FloatArray
    weights: FloatArray
    loss: FloatArray
    lights: FloatArray


def fit_pixels(
    tile: Tile,
    reflection: Reflection,
    normals: FloatArray,
    weights: FloatArray,
    scale: float,
    steps: int,
    prior: Prior | None = None,
) -> Pixels:
    """Return the normals and weights of a tile's pixels after some steps of the search.

    The search begins at `normals` (n, 3) and `weights` (n, channels, lobes). `scale` is the typical
    size of relative residuals.
    """
    real = choose_float_type()
    n, a = to_vector(normals), split_weights(weights)
    best_n, best_a = n, a
    best: JitFloat = dr.full(real, np.inf, tile.count)
    damping: JitFloat = dr.full(real, DAMPING, tile.count)
    equations = None
    for _ in range(steps):
        there = compute_equations(tile, reflection, n, a, scale, prior)
        better = there.loss < best
        damping = damping * dr.select(better, BETTER, WORSE)
        best_n = _choose_vector(better, n, best_n)
        best_a = _choose_nested(better, a, best_a)
        equations = there if equations is None else _choose_equations(better, there, equations)
        best = dr.minimum(best, there.loss)
        a, (p, q) = compute_step(equations, best_a, damping)
        n = tilt(best_n, *make_tangents(best_n), p, q)
        dr.eval(
            n.x, n.y, n.z, a, best, damping, best_n.x, best_n.y, best_n.z, best_a, _list(equations)
        )
    last = compute_equations(tile, reflection, n, a, scale, prior)
    better = last.loss < best
    best_n, best_a = _choose_vector(better, n, best_n), _choose_nested(better, a, best_a)
    lights = last.lights if equations is None else dr.select(better, last.lights, equations.lights)
    best = dr.minimum(best, last.loss)
    dr.eval(best_n.x, best_n.y, best_n.z, best_a, best, lights)
    return Pixels(to_numpy(best_n), join_weights(best_a), np.array(best), np.array(lights))


def split_weights(weights: FloatArray) -> list[list[JitFloat]]:
    """Convert weights of NumPy (n, channels, lobes) to arrays of Dr.Jit by channel and lobe."""
    return [[to_array(weights[:, c, k]) for k in range(weights.shape[2])] for c in range(CHANNELS)]


def join_weights(a: list[list[JitFloat]]) -> FloatArray:
    """Convert weights of Dr.Jit by channel and lobe to an array of NumPy (n, channels, lobes)."""
    return np.stack([np.stack([np.array(w) for w in row], axis=1) for row in a], axis=1)


def _list(equations: Equations) -> list[Any]:
    """Return the arrays of equations as a list, for Dr.Jit to evaluate."""
    return list(vars(equations).values())


def _choose_vector(condition: JitFloat, a: JitVector, b: JitVector) -> JitVector:
    """Return the vector `a` where a condition holds, else `b`."""
    return Vector(*(dr.select(condition, getattr(a, k), getattr(b, k)) for k in "xyz"))


def _choose_nested(condition: JitFloat, a: Any, b: Any) -> Any:
    """Return the arrays in nested lists `a` where a condition holds, else those in `b`."""
    if isinstance(a, list) and isinstance(b, list):
        return [_choose_nested(condition, x, y) for x, y in zip(a, b, strict=True)]
    return dr.select(condition, a, b)


def _choose_equations(condition: JitFloat, a: Equations, b: Equations) -> Equations:
    """Return the equations `a` of the pixels where a condition holds, else `b`."""
    pairs = zip(_list(a), _list(b), strict=True)
    return Equations(*(_choose_nested(condition, x, y) for x, y in pairs))
