"""Solves for the weights of a fit: least squares with some weights ≥ 0, and Newton's method."""

import numpy as np

# Columns are multiplied in parts of this many samples, which stay in the processor's cache
PART = 2**14


def weighted_gram(columns, weight):
    """C diag(w) Cᵀ (lobes, lobes) of `columns` C (lobes, n) and `weight` w (n,)."""
    gram = np.zeros((len(columns), len(columns)))
    for start in range(0, len(weight), PART):
        part = columns[:, start : start + PART]
        gram += (part * weight[start : start + PART]) @ part.T
    return gram


def make_positive_definite(hessian):
    """A symmetric matrix (n, n) with its eigenvalues replaced by their absolute values, away from
    0."""
    eigenvalues, vectors = np.linalg.eigh(hessian)
    eigenvalues = np.maximum(np.abs(eigenvalues), 1e-12 * np.abs(eigenvalues).max() + 1e-300)
    return (vectors * eigenvalues) @ vectors.T


def minimise_quadratic(hessian, moment, bounded=None):
    """The a (n,) that minimises ½ aᵀ H a - mᵀ a; H (n, n) is positive semidefinite.

    `bounded` (n,) marks the entries of a that may not be negative; by default all of them.

    >>> minimise_quadratic(np.eye(2), np.array([1.0, -1.0]))
    array([1., 0.])
    """
    bounded = np.ones(len(moment), bool) if bounded is None else bounded
    # Scale to a unit diagonal, so that a weak lobe is not lost beside a strong one
    scale = np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    form = hessian / np.outer(scale, scale) + 1e-14 * np.eye(len(scale))
    moment = moment / scale
    solution = np.zeros(len(moment))
    if bounded.all():
        solution = _solve_nonnegative(form, moment)
    else:
        # Eliminate the free entries, which are linear in the bounded ones (Schur complement)
        free = ~bounded
        by_bounded = np.linalg.solve(form[np.ix_(free, free)], form[np.ix_(free, bounded)])
        at_zero = np.linalg.solve(form[np.ix_(free, free)], moment[free])
        if bounded.any():
            left = form[np.ix_(bounded, bounded)] - form[np.ix_(bounded, free)] @ by_bounded
            rest = moment[bounded] - form[np.ix_(bounded, free)] @ at_zero
            solution[bounded] = _solve_nonnegative(left, rest)
        solution[free] = at_zero - by_bounded @ solution[bounded]
    return solution / scale


def newton(expand, start, bounded):
    """The a (n,) near `start` (n,) that minimises a function; `bounded` as in `minimise_quadratic`.

    `expand(a)` gives the function's value, its gradient (n,) and a positive definite Hessian
    (n, n); a factor that the gradient and the Hessian share does not matter.
    """
    weights, (error, gradient, hessian) = start, expand(start)
    for _ in range(30):
        moment = hessian @ weights - gradient
        step = minimise_quadratic(hessian, moment, bounded) - weights
        # Halve the step until the function does not rise
        for _halving in range(12):
            expansion = expand(weights + step)
            if expansion[0] <= error * (1 + 1e-14):
                break
            step = step / 2
        else:
            return weights
        weights, (error, gradient, hessian) = weights + step, expansion
        # Newton's method converges quadratically: after a step of 1e-6 the error is about 1e-12
        if np.all(np.abs(step) <= 1e-6 * np.abs(weights).max(initial=1e-9)):
            break
    return weights


def _solve_nonnegative(form, moment):
    """The a (n,) ≥ 0 that minimises ½ aᵀ F a - mᵀ a, for F = `form` and m = `moment`."""
    from scipy.optimize import nnls

    factor = np.linalg.cholesky(form + 1e-15 * np.eye(len(form)))
    return nnls(factor.T, np.linalg.solve(factor, moment))[0]
