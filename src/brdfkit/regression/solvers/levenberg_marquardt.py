"""`LevenbergMarquardt`: damped Gauss-Newton steps from all starts at once; what `fit` does itself.

[Levenberg 1944]; [Marquardt 1963].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.arguments import check_numbers
from brdfkit.regression.search.multistart import EXACT, MOST_STEPS, search
from brdfkit.regression.solvers.objective import End, Floats, Objective


@dataclass(frozen=True)
class LevenbergMarquardt:
    """Damped Gauss-Newton steps from all starts side by side; the solver of `fit` by default.

    Parameters
    ----------
    iterations : int, default 200
        The most steps of one search.
    tolerance : float, default 1e-11
        A search ends where its next step would lower E² by less than this share of it; of large
        tables, a hundred times as much.

    Examples
    --------
    >>> fit("paint.binary", "ggx", solver=LevenbergMarquardt(iterations=50))    # doctest: +SKIP
    """

    iterations: int = MOST_STEPS
    tolerance: float = EXACT

    def __post_init__(self) -> None:
        check_numbers(self)

    def minimise(self, objective: Objective) -> End:
        """The end of the search."""
        return self.find_ends(objective, objective.coordinates)[0]

    def find_ends(self, objective: Objective, coordinates: Floats) -> list[End]:
        """The best ends of the search from `coordinates` (count, shapes), the very best first."""
        problems = [stage.problem for stage in objective.stages()]
        ends, converged, evaluations = search(
            problems, coordinates, objective.report, self.iterations, self.tolerance
        )
        objective.evaluations += evaluations
        points = objective.join(ends.u, ends.weights)
        stopped = f"stopped after {self.iterations} steps"
        messages = np.where(converged, "converged", stopped).tolist()
        return list(map(End, points, ends.error.tolist(), messages))
