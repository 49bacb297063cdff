"""Minimises quadratic functions within boxes, several at a time: the inner step of every fit."""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray

# After this number of rounds only one entry changes at a time, so that no active set repeats
PARALLEL_ROUNDS = 10


def minimise_in_box(
    hessian: FloatArray, gradient: FloatArray, low: float | FloatArray, high: float | FloatArray
) -> FloatArray:
    """Return the z (b, n) that minimise ½ zᵀ H z + gᵀ z with `low` ≤ z ≤ `high`.

    `hessian` H (b, n, n): positive semidefinite; `gradient` g, `low`, `high`: arrays that broadcast
    to (b, n). The active sets change by the signs of the solution and of its multipliers, in all
    entries at once [Hintermüller et al. 2002], later at the smallest index only [Murty 1974].

    >>> minimise_in_box(np.eye(2)[None], np.array([[-1.0, 1.0]]), 0.0, np.inf)
    array([[1., 0.]])
    """
    # Scale to a unit diagonal, so that a weak column is not lost beside a strong one
    n = gradient.shape[1]
    scale = 1 / np.sqrt(np.maximum(hessian.diagonal(axis1=1, axis2=2), 1e-300))
    form = hessian * (scale[:, :, None] * scale[:, None, :])
    form[:, range(n), range(n)] += 1e-14
    force = gradient * scale
    z = np.linalg.solve(form, -force[:, :, None])[:, :, 0]
    low, high = low / scale, high / scale
    at_low, at_high = z < low, z > high
    for round_ in range(PARALLEL_ROUNDS + 20 * n):
        fixed = at_low | at_high
        if not fixed.any():
            break
        z = np.where(at_low, low, np.where(at_high, high, 0.0))
        z = _solve_free_entries(form, force, fixed, z)
        slope = (form @ z[:, :, None])[:, :, 0] + force
        to_low = np.where(fixed, at_low & (slope > 0), z < low)
        to_high = np.where(fixed, at_high & (slope < 0), z > high)
        changed = (to_low != at_low) | (to_high != at_high)
        if not changed.any():
            break
        if round_ >= PARALLEL_ROUNDS:
            first = np.arange(n) == changed.argmax(axis=1)[:, None]
            to_low, to_high = np.where(first, to_low, at_low), np.where(first, to_high, at_high)
        at_low, at_high = to_low, to_high
    return np.minimum(np.maximum(z, low), high) * scale


def _solve_free_entries(
    form: FloatArray, force: FloatArray, fixed: BoolArray, values: FloatArray
) -> FloatArray:
    """Return z with z = `values` where `fixed`, and F z + f = 0 elsewhere."""
    free = ~fixed
    reduced = form * (free[:, :, None] & free[:, None, :])
    n = form.shape[1]
    reduced[:, range(n), range(n)] += fixed
    right = -force - (form @ np.where(fixed, values, 0.0)[:, :, None])[:, :, 0]
    z = np.linalg.solve(reduced, np.where(fixed, 0.0, right)[:, :, None])[:, :, 0]
    return np.where(fixed, values, z)
