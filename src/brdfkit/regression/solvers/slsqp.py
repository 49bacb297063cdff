"""Defines `SLSQP`, sequential quadratic programming, the default solver for fits with constraints.

It is the method of [Kurt 2007, ch. 5], in SciPy's implementation of [Kraft 1988].
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.arguments import check_number_fields
from brdfkit.core.array_types import FloatArray
from brdfkit.regression.solvers.levenberg_marquardt import LevenbergMarquardt
from brdfkit.regression.solvers.objective import End, Objective
from brdfkit.regression.solvers.several_starts import find_best_starts, search_in_stages

# Largest number of SciPy's searches: each may end too early, so it is repeated in new units
REPETITIONS = 8
# SciPy minimises E² divided by its value at the start, or by this share of a black model's E² if
# that is larger
SMALLEST_UNIT = 1e-6


@dataclass(frozen=True)
class SLSQP:
    """A search by sequential quadratic programming, with `scipy.optimize.minimize`.

    It is the default solver of `fit` with constraints, and uses exact gradients.

    Parameters
    ----------
    iterations : int, default 200
        Largest number of steps of one search.
    tolerance : float, default 1e-10
        A search ends if another one from its end lowers the squared loss by less than this share of
        it.
    starts : int, default 8
        Number of starts to search from, those with the least loss. With constraints, the search
        starts from the ends of `LevenbergMarquardt` without them.

    Examples
    --------
    >>> fit("paint.binary", "ward", solver=SLSQP(starts=4))    # doctest: +SKIP
    """

    iterations: int = 200
    tolerance: float = 1e-10
    starts: int = 8

    constrained = True  # the solver meets constraints

    def __post_init__(self) -> None:
        check_number_fields(self)

    def minimise(self, objective: Objective) -> End:
        """Return the `End` with the least squared loss that meets the constraints."""
        if objective.constraints is None:
            return search_in_stages(
                objective, self._search_from_point, find_best_starts(objective, self.starts)
            )
        # If the optimum without constraints happens to meet them, it is the result
        free = LevenbergMarquardt().search_best_ends(objective, objective.coordinates)
        if objective.constraints.are_met(free[0].point):
            return free[0]
        end = search_in_stages(objective, self._search_from_point, [end.point for end in free])
        without = f"without the constraints E would be {math.sqrt(free[0].error):.6g}"
        return replace(end, message=f"{end.message}; {without}")

    def _search_from_point(self, objective: Objective, z: FloatArray) -> End:
        """Return the `End` of a search from one point `z` (n,)."""
        u, weights = objective.split(z[None])
        least = SMALLEST_UNIT * objective.error(objective.join(u, 0 * weights))[0]
        for _ in range(REPETITIONS):
            here = objective.expand(z)
            if not (scale := max(here.error[0], least)):
                return End(z, 0.0)
            z, error = self._run_scipy_search(objective, z, here.hessian[0] / scale, scale)
            if abs(here.error[0] - error) <= self.tolerance * scale:
                return End(z, error)
        return End(z, error, f"stopped after {REPETITIONS} searches")

    def _run_scipy_search(
        self, objective: Objective, start: FloatArray, hessian: FloatArray, scale: float
    ) -> tuple[FloatArray, float]:
        """Return the end (z, squared loss E²) of one search by SciPy from the point `start` (n,).

        `hessian` (n, n): Hessian of E² / `scale` at the start, which decides the units.
        """
        from scipy.optimize import Bounds, minimize

        # In these units E² has equal curvature along all axes, as SciPy's search expects
        unit = 1 / np.sqrt(np.maximum(hessian.diagonal(), 1))

        def compute_error(y: FloatArray) -> tuple[float, FloatArray]:
            """Return the squared loss over `scale` and its gradient at a point `y` (n,)."""
            there = objective.expand(objective.clip(y * unit), curvature=False)
            return there.error[0] / scale, 2 * there.gradient[0] * unit / scale

        constraints = objective.constraints
        limits = {
            "type": "ineq",
            "fun": lambda y: constraints.values(y * unit),
            "jac": lambda y: constraints.slopes(y * unit) * unit,
        }
        result = minimize(
            compute_error,
            start / unit,
            jac=True,
            method="SLSQP",
            bounds=Bounds(objective.low / unit, objective.high / unit),
            constraints=[limits] if constraints else [],
            options={"maxiter": self.iterations, "ftol": self.tolerance / 100},
        )
        return objective.clip(result.x * unit), result.fun * scale
