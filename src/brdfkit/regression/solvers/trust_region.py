"""Defines `TrustRegion`, a solver with Gauss-Newton steps within a trust region.

SciPy's `least_squares` with its method "trf" [Branch et al. 1999] takes residuals and their
Jacobian, which would be a gigabyte for a full table. But SciPy uses only their products. So it
receives few residuals r and a small Jacobian J with the same products: the squared loss E² = rᵀr,
half its gradient, g = Jᵀr, and half its Hessian, H = JᵀJ. SciPy's "trust-constr" with the same
Hessian reaches the same end after three to seven times as many evaluations.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.arguments import check_number_fields
from brdfkit.core.array_types import FloatArray
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.solvers.objective import End, Objective
from brdfkit.regression.solvers.several_starts import find_best_starts, search_in_stages

# Eigenvalues of a Hessian below this share of the largest one are rounding errors, and count as 0
SINGULAR = 1e-14


@dataclass(frozen=True)
class TrustRegion:
    """A search by Gauss-Newton steps within a trust region, with `scipy.optimize.least_squares`.

    Parameters
    ----------
    iterations : int, default 200
        Largest number of steps of one search.
    tolerance : float, default 1e-12
        A search ends if a step lowers the squared loss by less than this share of it.
    starts : int, default 8
        Number of starts to search from, those with the least loss.

    Examples
    --------
    >>> fit("paint.binary", "ward", solver=TrustRegion(starts=4))    # doctest: +SKIP
    """

    iterations: int = 200
    tolerance: float = 1e-12
    starts: int = 8

    def __post_init__(self) -> None:
        check_number_fields(self)

    def minimise(self, objective: Objective) -> End:
        """Return the `End` with the least squared loss that the search finds."""
        return search_in_stages(
            objective, self._search_from_point, find_best_starts(objective, self.starts)
        )

    def _search_from_point(self, objective: Objective, z: FloatArray) -> End:
        """Return the `End` of a search from one point `z` (n,)."""
        from scipy.optimize import least_squares

        cache: dict[bytes, tuple[FloatArray, FloatArray]] = {}

        def compress_samples(z: FloatArray) -> tuple[FloatArray, FloatArray]:
            """Return residuals and Jacobian at a point, evaluated once for both calls of SciPy."""
            if z.tobytes() not in cache:
                cache.clear()
                cache[z.tobytes()] = _compress_expansion(objective.expand(z))
            return cache[z.tobytes()]

        result = least_squares(
            lambda z: compress_samples(z)[0],
            z,
            lambda z: compress_samples(z)[1],
            bounds=(objective.low, objective.high),
            x_scale="jac",
            ftol=self.tolerance,
            xtol=self.tolerance,
            gtol=self.tolerance,
            max_nfev=self.iterations,
        )
        message = "converged" if result.status > 0 else f"stopped after {self.iterations} steps"
        return End(result.x, 2 * result.cost, message)


def _compress_expansion(expansion: Expansion) -> tuple[FloatArray, FloatArray]:
    """Return few residuals (n + 1,) and a small Jacobian (n + 1, n) that stand for all samples.

    Their products are the squared loss, its gradient and its Hessian in the `expansion`, which is
    about one point with n parameters.
    """
    values, vectors = np.linalg.eigh(expansion.hessian[0])
    roots = np.sqrt(np.where(values > SINGULAR * values.max(), values, 0))
    along = vectors.T @ expansion.gradient[0]
    residuals = np.divide(along, roots, out=np.zeros_like(along), where=roots > 0)
    rest = max(expansion.error[0] - residuals @ residuals, 0)
    jacobian = np.vstack([roots[:, None] * vectors.T, np.zeros(len(roots))])
    return np.append(residuals, np.sqrt(rest)), jacobian
