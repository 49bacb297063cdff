"""Defines the weight functions of robust fits, which reduce the influence of outliers.

A robust fit repeats least squares. Each pass weights a sample by a function ω of its scaled
residual r after the pass before:

    r = residual / (tune · s · √(1 - h)),   s = MAD / 0.6745.

Here h is the leverage of the sample, MAD the median of the absolute residuals, s the scale of the
noise, and `tune` a constant of the function. [Holland & Welsch 1977]; [Kurt 2007, eqs. 5.14, 5.15].
The constants and the order of the steps are those of MATLAB's robustfit.

The bisquare function ignores noise, but also any peak that the model cannot follow. To notice this,
compare the loss with the loss of a fit that is not robust.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError

ZERO_BELL = 30.0  # exp(-r²) is 0 in floating point for larger r


def _compute_andrews_weight(r: FloatArray) -> FloatArray:
    return np.where(np.abs(r) < np.pi, np.sinc(r / np.pi), 0)


def _compute_logistic_weight(r: FloatArray) -> FloatArray:
    return np.tanh(r) / np.where(r == 0, 1, r) + (r == 0)


def _compute_welsch_weight(r: FloatArray) -> FloatArray:
    return np.exp(-(np.minimum(np.abs(r), ZERO_BELL) ** 2))


def _make_piecewise_function(
    limit: float, inside: Callable[[FloatArray], Any], outside: Callable[[FloatArray], Any]
) -> Callable[[FloatArray], FloatArray]:
    """Return a function of |r| that is `inside(r)` up to `limit`, and `outside(r)` beyond."""

    def evaluate_piecewise(r: FloatArray) -> FloatArray:
        """Return the values (n,) of the function at scaled residuals (n,)."""
        r = np.abs(r)
        return np.where(r < limit, inside(np.minimum(r, limit)), outside(r))

    return evaluate_piecewise


# By name of a weight function: ω(r), the constant `tune` by which r is divided, and the integral
# ρ(r) of ω(r) r
WEIGHTS = {
    "andrews": (
        _compute_andrews_weight,
        1.339,
        _make_piecewise_function(np.pi, lambda r: 1 - np.cos(r), lambda r: 2.0),
    ),
    "bisquare": (
        lambda r: (1 - np.minimum(np.abs(r), 1) ** 2) ** 2,
        4.685,
        _make_piecewise_function(1, lambda r: (1 - (1 - r**2) ** 3) / 6, lambda r: 1 / 6),
    ),
    "cauchy": (
        lambda r: 1 / (1 + np.minimum(np.abs(r), 1e100) ** 2),
        2.385,
        lambda r: np.log1p(r**2) / 2,
    ),
    "fair": (lambda r: 1 / (1 + np.abs(r)), 1.4, lambda r: np.abs(r) - np.log1p(np.abs(r))),
    "huber": (
        lambda r: 1 / np.maximum(1, np.abs(r)),
        1.345,
        _make_piecewise_function(1, lambda r: r**2 / 2, lambda r: r - 0.5),
    ),
    "logistic": (_compute_logistic_weight, 1.205, lambda r: np.logaddexp(r, -r) - np.log(2)),
    "talwar": (
        lambda r: (np.abs(r) < 1).astype(float),
        2.795,
        _make_piecewise_function(1, lambda r: r**2 / 2, lambda r: 0.5),
    ),
    "welsch": (_compute_welsch_weight, 2.985, lambda r: (1 - _compute_welsch_weight(r)) / 2),
}


def estimate_residual_scale(residuals: FloatArray, rank: int, least: float) -> float:
    """Return the scale s of the noise, the median of absolute `residuals` (n,) over 0.6745.

    The residuals are already divided by √(1 - leverage). `rank`: the number of parameters; the
    smallest rank - 1 residuals are nearly zero by construction and are left out. `least`: lower
    limit of the scale, because smaller residuals are rounding errors.
    """
    left = len(residuals) - max(rank - 1, 0)
    # Indices of the one or two residuals in the middle of the larger ones, which give the median
    middle = len(residuals) - left + (left - 1) // 2, len(residuals) - left + left // 2
    ordered = np.partition(np.abs(residuals), middle)
    return max((ordered[middle[0]] + ordered[middle[1]]) / 2 / 0.6745, least)


def require_more_samples_than_parameters(samples: int, rank: int) -> None:
    """Raise `BrdfkitError` unless there are more `samples` than parameters.

    Otherwise the model can meet every sample, and no residual shows the scale of the noise.
    """
    if samples <= rank:
        raise BrdfkitError(
            f"A robust fit needs more samples than parameters; here are {samples} and {rank}: "
            "give more samples, a simpler model, or no robust."
        )


def compute_smallest_scale(values: FloatArray) -> float:
    """Return a lower limit of the scale of residuals, below which they are rounding errors.

    It is a millionth of the standard deviation of `values` (n,), the values that were fitted.
    """
    return 1e-6 * float(np.std(values, ddof=1)) or 1.0


def orthonormalise(columns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return an orthonormal basis (rank, n) of the sums of `columns` (parameters, n).

    Return also the matrix (parameters, rank) that turns coefficients of the basis into those of
    the columns. The rank is smaller than the number of columns if some are sums of others.
    """
    u, values, v = np.linalg.svd(columns.T, full_matrices=False)
    kept = values > values.max(initial=0) * len(u) * np.finfo(float).eps
    return u[:, kept].T, v[kept].T / values[kept]


def compute_leverages(columns: FloatArray) -> FloatArray:
    """Return the leverages h (n,) of samples, between 0 and 0.9999.

    They say how much a sample determines its own fitted value. `columns` (parameters, n):
    derivatives of the fitted values; h is the diagonal of the projection onto them.
    """
    basis, _ = orthonormalise(columns)
    return np.minimum((basis * basis).sum(axis=0), 0.9999)
