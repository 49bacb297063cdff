"""Minimises quadratic functions of variables with lower and upper bounds.

Every step of a fit solves such problems, several at a time, for a step within the bounds of the
parameters.
"""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray

# Number of rounds in which many variables at once may move onto or off their bounds. In later
# rounds only one moves, so that the search is sure to end
PARALLEL_ROUNDS = 10


def minimise_in_box(
    hessian: FloatArray, gradient: FloatArray, low: float | FloatArray, high: float | FloatArray
) -> FloatArray:
    """Return the minima z (b, n) of b functions ½ zᵀ H z + gᵀ z with `low` ≤ z ≤ `high`.

    `hessian`: the positive semidefinite matrices H (b, n, n); `gradient`: the vectors g (b, n);
    `low`, `high`: bounds that broadcast to (b, n). A variable moves onto a bound that it
    violates, and off a bound if the function falls towards the inside: all at once in the first
    rounds [Hintermüller et al. 2002], later only the one with the smallest index [Murty 1974].

    >>> minimise_in_box(np.eye(2)[None], np.array([[-1.0, 1.0]]), 0.0, np.inf)
    array([[1., 0.]])
    """
    # Variables are scaled so that the diagonal of the Hessian is 1. Otherwise rounding errors would
    # hide a variable whose entries are small
    n = gradient.shape[1]
    scale = 1 / np.sqrt(np.maximum(hessian.diagonal(axis1=1, axis2=2), 1e-300))
    form = hessian * (scale[:, :, None] * scale[:, None, :])
    form.reshape(-1, n * n)[:, :: n + 1] += 1e-14  # the diagonals
    force = gradient * scale
    z = np.linalg.solve(form, -force[:, :, None])[:, :, 0]
    least, most = low, high
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
    # A variable on a bound is there exactly, in spite of the scaling
    return np.where(z <= low, least, np.where(z >= high, most, z * scale))


def _solve_free_entries(
    form: FloatArray, force: FloatArray, fixed: BoolArray, values: FloatArray
) -> FloatArray:
    """Return the minima (b, n) with some variables fixed, without bounds on the others.

    `form` (b, n, n), `force` (b, n): Hessians and gradients; `fixed` (b, n): whether a variable
    keeps its entry of `values` (b, n).
    """
    free = ~fixed
    reduced = form * (free[:, :, None] & free[:, None, :])
    n = form.shape[1]
    reduced.reshape(-1, n * n)[:, :: n + 1] += fixed
    right = -force - (form @ np.where(fixed, values, 0.0)[:, :, None])[:, :, 0]
    z = np.linalg.solve(reduced, np.where(fixed, 0.0, right)[:, :, None])[:, :, 0]
    return np.where(fixed, values, z)
