"""`SLSQP`: sequential quadratic programming, the method of the thesis, and the one for constraints.

[Kurt 2007, ch. 5]; SciPy's, which is [Kraft 1988].
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.arguments import check_numbers
from brdfkit.regression.solvers.levenberg_marquardt import LevenbergMarquardt
from brdfkit.regression.solvers.objective import End, Objective
from brdfkit.regression.solvers.several_starts import best_starts, descend

# A search is repeated from its end, so often, in new units: in those of its start it may end early
REPEATED = 8
# E², as a share of that of a black model, below which it is not the unit
SMALL = 1e-6


@dataclass(frozen=True)
class SLSQP:
    """Sequential quadratic programming with exact gradients, by `scipy.optimize.minimize`; the
    solver of `fit` where there are constraints.

    Parameters
    ----------
    iterations : int, default 200
        The most steps of one search.
    tolerance : float, default 1e-10
        A search ends where, begun anew at its end, it lowers E² by less than this share of it.
    starts : int, default 8
        How many of the starts are searched from: those with the least E². With constraints, the
        search begins instead where `LevenbergMarquardt` ends without them.

    Examples
    --------
    >>> fit("paint.binary", "ward", solver=SLSQP(starts=4))    # doctest: +SKIP
    """

    iterations: int = 200
    tolerance: float = 1e-10
    starts: int = 8

    constrained = True  # takes constraints

    def __post_init__(self) -> None:
        check_numbers(self)

    def minimise(self, objective: Objective) -> End:
        """The end of the search."""
        if objective.constraints is None:
            return descend(objective, self._search, best_starts(objective, self.starts))
        # Where the optimum without constraints meets them, it is the answer
        free = LevenbergMarquardt().find_ends(objective, objective.coordinates)
        if objective.constraints.met(free[0].point):
            return free[0]
        end = descend(objective, self._search, [end.point for end in free])
        without = f"without the constraints E would be {math.sqrt(free[0].error):.6g}"
        return replace(end, message=f"{end.message}; {without}")

    def _search(self, objective, z):
        """The `End` of the search from one point."""
        u, weights = objective.split(z[None])
        least = SMALL * objective.error(objective.join(u, 0 * weights))[0]
        for _ in range(REPEATED):
            here = objective.expand(z)
            if not (scale := max(here.error[0], least)):
                return End(z, 0.0)
            z, error = self._search_once(objective, z, here.hessian[0] / scale, scale)
            if abs(here.error[0] - error) <= self.tolerance * scale:
                return End(z, error)
        return End(z, error, f"stopped after {REPEATED} searches")

    def _search_once(self, objective, start, hessian, scale):
        """The end (z, E²) of SciPy's search from a point with the Hessian of E² / scale."""
        from scipy.optimize import Bounds, minimize

        # In units by which E² is about 1 and curves alike along all axes, as steps of 1 should be
        unit = 1 / np.sqrt(np.maximum(hessian.diagonal(), 1))

        def error(y):
            there = objective.expand(objective.clip(y * unit), curvature=False)
            return there.error[0] / scale, 2 * there.gradient[0] * unit / scale

        constraints = objective.constraints
        limits = {
            "type": "ineq",
            "fun": lambda y: constraints.values(y * unit),
            "jac": lambda y: constraints.slopes(y * unit) * unit,
        }
        found = minimize(
            error,
            start / unit,
            jac=True,
            method="SLSQP",
            bounds=Bounds(objective.low / unit, objective.high / unit),
            constraints=[limits] if constraints else [],
            options={"maxiter": self.iterations, "ftol": self.tolerance / 100},
        )
        return objective.clip(found.x * unit), found.fun * scale
