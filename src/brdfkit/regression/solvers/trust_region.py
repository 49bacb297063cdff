"""`TrustRegion`: Gauss-Newton steps within a region of trust, by SciPy's `least_squares`.

Its method "trf" [Branch et al. 1999] takes residuals and their Jacobian, which for a full table
would be a gigabyte. It needs their products alone; so it is given the few residuals r and the small
Jacobian J that have the same ones: E² = rᵀr, g = Jᵀr and H = JᵀJ. SciPy's "trust-constr" with the
same Hessian ends where "trf" does, after three to seven times as many evaluations.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.arguments import check_numbers
from brdfkit.regression.solvers.objective import End, Objective
from brdfkit.regression.solvers.several_starts import best_starts, descend

# Eigenvalues of a Hessian, beside the largest, that are rounding
SINGULAR = 1e-14


@dataclass(frozen=True)
class TrustRegion:
    """Gauss-Newton steps within a region of trust, by `scipy.optimize.least_squares` ("trf").

    Parameters
    ----------
    iterations : int, default 200
        The most steps of one search.
    tolerance : float, default 1e-12
        A search ends where a step lowers E² by less than this share of it.
    starts : int, default 8
        How many of the starts are searched from: those with the least E².

    Examples
    --------
    >>> fit("paint.binary", "ward", solver=TrustRegion(starts=4))    # doctest: +SKIP
    """

    iterations: int = 200
    tolerance: float = 1e-12
    starts: int = 8

    def __post_init__(self) -> None:
        check_numbers(self)

    def minimise(self, objective: Objective) -> End:
        """The end of the search."""
        return descend(objective, self._search, best_starts(objective, self.starts))

    def _search(self, objective, z):
        """The `End` of the search from one point."""
        from scipy.optimize import least_squares

        known = {}

        def compress(z):
            if z.tobytes() not in known:
                known.clear()
                known[z.tobytes()] = _compress(objective.expand(z))
            return known[z.tobytes()]

        found = least_squares(
            lambda z: compress(z)[0],
            z,
            lambda z: compress(z)[1],
            bounds=(objective.low, objective.high),
            x_scale="jac",
            ftol=self.tolerance,
            xtol=self.tolerance,
            gtol=self.tolerance,
            max_nfev=self.iterations,
        )
        message = "converged" if found.status > 0 else f"stopped after {self.iterations} steps"
        return End(found.x, 2 * found.cost, message)


def _compress(expansion):
    """The residuals (n + 1,) and the Jacobian (n + 1, n) of an `Expansion` about one point."""
    values, vectors = np.linalg.eigh(expansion.hessian[0])
    roots = np.sqrt(np.where(values > SINGULAR * values.max(), values, 0))
    along = vectors.T @ expansion.gradient[0]
    residuals = np.divide(along, roots, out=np.zeros_like(along), where=roots > 0)
    rest = max(expansion.error[0] - residuals @ residuals, 0)
    jacobian = np.vstack([roots[:, None] * vectors.T, np.zeros(len(roots))])
    return np.append(residuals, np.sqrt(rest)), jacobian
