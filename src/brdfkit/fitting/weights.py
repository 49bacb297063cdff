"""The bounded linear least squares inside a fit."""

import numpy as np


def bounded_quadratic(hessian, moment):
    """The a ≥ 0 (n,) that minimises ½ aᵀ H a - mᵀ a; H (n, n) positive semidefinite.

    >>> bounded_quadratic(np.eye(2), np.array([1.0, -1.0]))
    array([1., 0.])
    """
    from scipy.optimize import nnls

    # Columns at unit length, so that a weak lobe is not lost beside a strong one
    scale = np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    correlation = hessian / np.outer(scale, scale)
    factor = np.linalg.cholesky(correlation + 1e-14 * np.eye(len(scale)))
    solution, _ = nnls(factor.T, np.linalg.solve(factor, moment / scale))
    return solution / scale
