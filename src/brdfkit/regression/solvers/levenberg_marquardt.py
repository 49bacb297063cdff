"""Defines `LevenbergMarquardt`, the default solver: damped Gauss-Newton steps from all starts.

[Levenberg 1944]; [Marquardt 1963].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.arguments import check_number_fields
from brdfkit.core.array_types import FloatArray
from brdfkit.regression.search.multistart import EXACT, LARGEST_STEPS, search_from_starts
from brdfkit.regression.solvers.objective import End, Objective


@dataclass(frozen=True)
class LevenbergMarquardt:
    """A search by damped Gauss-Newton steps, from all starts at once; the default of `fit`.

    Parameters
    ----------
    iterations : int, default 200
        Largest number of steps of one search.
    tolerance : float, default 1e-11
        A search ends if its next step would lower the squared loss by less than this share of it;
        for large tables, by less than a hundred times this share.

    Examples
    --------
    >>> fit("paint.binary", "ggx", solver=LevenbergMarquardt(iterations=50))    # doctest: +SKIP
    """

    iterations: int = LARGEST_STEPS
    tolerance: float = EXACT

    def __post_init__(self) -> None:
        check_number_fields(self)

    def minimise(self, objective: Objective) -> End:
        """Return the `End` with the least squared loss that the search finds."""
        return self.search_best_ends(objective, objective.coordinates)[0]

    def search_best_ends(self, objective: Objective, coordinates: FloatArray) -> list[End]:
        """Return the best results (`End`) of searches from several start points, the best first.

        `coordinates` (count, shapes): the start points; weights are computed for them.
        """
        problems = [stage.problem for stage in objective.stages()]
        ends, converged, evaluations = search_from_starts(
            problems, coordinates, objective.report, self.iterations, self.tolerance
        )
        objective.evaluations += evaluations
        points = objective.join(ends.u, ends.weights)
        stopped = f"stopped after {self.iterations} steps"
        messages = np.where(converged, "converged", stopped).tolist()
        return list(map(End, points, ends.error.tolist(), messages))
