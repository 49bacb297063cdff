"""The weights inside a fit: least squares where some a ≥ 0, and Newton's method about them."""

import numpy as np

# Columns are multiplied by parts that stay in the processor's cache
PART = 2**14


def weighted_gram(columns, weight):
    """C diag(w) Cᵀ (lobes, lobes) of `columns` C (lobes, n) and `weight` w (n,)."""
    gram = np.zeros((len(columns), len(columns)))
    for start in range(0, len(weight), PART):
        part = columns[:, start : start + PART]
        gram += (part * weight[start : start + PART]) @ part.T
    return gram


def bounded_quadratic(hessian, moment, bounded=None):
    """The a (n,) that minimises ½ aᵀ H a - mᵀ a; H (n, n) positive semidefinite.

    `bounded` (n,) marks those that may not be negative; all of them, if it is not given.

    >>> bounded_quadratic(np.eye(2), np.array([1.0, -1.0]))
    array([1., 0.])
    """
    bounded = np.ones(len(moment), bool) if bounded is None else bounded
    # Columns at unit length, so that a weak lobe is not lost beside a strong one
    scale = np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    form = hessian / np.outer(scale, scale) + 1e-14 * np.eye(len(scale))
    moment = moment / scale
    solution = np.zeros(len(moment))
    if bounded.all():
        solution = _not_negative(form, moment)
    else:
        # The free ones are linear in the bounded ones: what is left is a smaller form
        free = ~bounded
        by_bounded = np.linalg.solve(form[np.ix_(free, free)], form[np.ix_(free, bounded)])
        at_zero = np.linalg.solve(form[np.ix_(free, free)], moment[free])
        if bounded.any():
            left = form[np.ix_(bounded, bounded)] - form[np.ix_(bounded, free)] @ by_bounded
            rest = moment[bounded] - form[np.ix_(bounded, free)] @ at_zero
            solution[bounded] = _not_negative(left, rest)
        solution[free] = at_zero - by_bounded @ solution[bounded]
    return solution / scale


def newton(expand, start, bounded):
    """The a (n,) that minimises a function near `start` (n,), within `bounded_quadratic`'s bounds.

    `expand(a)` gives its value, gradient (n,) and a positive definite Hessian (n, n).
    """
    weights, (error, gradient, hessian) = start, expand(start)
    for _ in range(30):
        moment = hessian @ weights - gradient
        step = bounded_quadratic(hessian, moment, bounded) - weights
        for _halving in range(12):
            expansion = expand(weights + step)
            if expansion[0] <= error * (1 + 1e-14):
                break
            step = step / 2
        else:
            return weights
        weights, (error, gradient, hessian) = weights + step, expansion
        # Newton's steps square: what is left after one of 1e-6 is 1e-12
        if np.all(np.abs(step) <= 1e-6 * np.abs(weights).max(initial=1e-9)):
            break
    return weights


def _not_negative(form, moment):
    from scipy.optimize import nnls

    factor = np.linalg.cholesky(form + 1e-15 * np.eye(len(form)))
    return nnls(factor.T, np.linalg.solve(factor, moment))[0]
