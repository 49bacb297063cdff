"""Adds up derivatives over the samples of a fit, for the covariance of its parameters.

The results are the two factors of the sandwich estimator in `certainty.py`: the Hessian of the
squared loss, and the scores, the contributions of the samples to its gradient.
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.regression.problem.parameter_space import find_channel_entries

# Smaller eigenvalues of a Hessian whose diagonal is 1 are rounding errors, and count as 0
SINGULAR = 1e-11
# Along an eigenvector of length 1, parameters with a smaller entry count as constant
ABSENT = 1e-3


def find_undetermined_at_bounds(
    jacobians: list[FloatArray], free: BoolArray, shapes: int
) -> BoolArray:
    """Return which parameters (n,) are on a bound although the data do not determine them.

    The loss stays the same if such a shape parameter moves together with others. So the search
    ended on the bound by mere chance. `free` (n,): whether a parameter is inside its bounds;
    `shapes`: number of shape parameters; `jacobians`: for each channel the derivatives (shapes +
    lobes, samples) of the residuals.
    """
    is_open = np.zeros(len(free), bool)
    moving = free.copy()
    # Add only shape parameters with an effect: those of a lobe of weight 0 have derivatives of 0
    moving[:shapes] |= np.any([jacobian[:shapes].any(axis=1) for jacobian in jacobians], axis=0)
    if (moving != free).any():
        hessian, _, _, _ = _sum_hessian(jacobians, moving, shapes)
        values, vectors = np.linalg.eigh(hessian)
        null = vectors[:, np.abs(values) <= SINGULAR * max(values.max(), 1)]
        is_open[moving] = (np.abs(null) > ABSENT).any(axis=1)
    return is_open & ~free


def compute_scores(
    residuals: list[FloatArray],
    jacobians: list[FloatArray],
    free: BoolArray,
    shapes: int,
    shares: FloatArray,
    passes: tuple[list[FloatArray], list[FloatArray]] | None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the scores (n, samples) and the Hessian (n, n) for the sandwich estimator.

    A score is the contribution of a sample to the gradient of the squared loss, over √(1 - its
    leverage). Both are in units of the n `free` parameters that make the diagonal of the Hessian 1;
    the units (n,) are returned, too. `residuals`, `jacobians`: by channel; `shares` (samples,): if
    the samples were drawn from many, the number for which each stands, otherwise 1; `passes`: as in
    `compute_certainty`.
    """
    hessian, scale, owns, jacobians = _sum_hessian(jacobians, free, shapes)
    inverse = np.linalg.pinv(hessian, rcond=SINGULAR, hermitian=True)
    scores = np.zeros((len(hessian), len(shares)))
    for c, (own, jacobian) in enumerate(zip(owns, jacobians, strict=True)):
        jacobian *= scale[own, None]
        lever = (jacobian * (inverse[np.ix_(own, own)] @ jacobian)).sum(axis=0) * shares
        factor = np.sqrt(shares / np.maximum(1 - lever, 1e-4))
        if passes:
            factor = factor * passes[0][c]
        scores[own] += jacobian * (residuals[c] * factor)
    if passes:
        hessian = np.zeros_like(hessian)
        for own, jacobian, slope in zip(owns, jacobians, passes[1], strict=True):
            hessian[np.ix_(own, own)] += (jacobian * slope) @ jacobian.T
    return scores, hessian, scale


def _sum_hessian(
    jacobians: list[FloatArray], free: BoolArray, shapes: int
) -> tuple[FloatArray, FloatArray, list[Any], list[FloatArray]]:
    """Return the scaled Hessian (n, n) of the squared loss by the n `free` parameters.

    Three more results follow: its units (n,), which make its diagonal 1; for each channel, the
    indices of the free parameters that it depends on; and the derivatives of its residuals with
    respect to them. `jacobians`: derivatives (shapes + lobes, samples) for each channel; `shapes`:
    number of shape parameters.
    """
    where = np.cumsum(free) - 1
    rows, derivatives = [], []
    for c, jacobian in enumerate(jacobians):
        own = find_channel_entries(c, shapes, len(jacobian) - shapes)
        rows.append(where[own[free[own]]])
        derivatives.append(jacobian[free[own]])
    hessian = np.zeros((free.sum(), free.sum()))
    for own, jacobian in zip(rows, derivatives, strict=True):
        hessian[np.ix_(own, own)] += jacobian @ jacobian.T
    scale = 1 / np.sqrt(np.maximum(np.diagonal(hessian), 1e-300))
    return hessian * np.outer(scale, scale), scale, rows, derivatives
