"""`DifferentialEvolution`: a global search by a population of points, for difficult fits.

SciPy's implementation of [Storn & Price 1997] searches the shape parameters; the best weights are
computed at each point.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.arguments import check_number_fields
from brdfkit.core.array_types import FloatArray
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.solvers.levenberg_marquardt import LevenbergMarquardt
from brdfkit.regression.solvers.objective import End, Objective

# Steps to the best weights at a point, if the loss is not linear
WEIGHT_STEPS = 4
# They stop if a step lowers no E² by more than this share
SETTLED = 1e-3


@dataclass(frozen=True)
class DifferentialEvolution:
    """Differential evolution, a global search by `scipy.optimize.differential_evolution`.

    `LevenbergMarquardt` refines its end. It takes longer, and depends less on the start points.

    Parameters
    ----------
    population : int, default 15
        Number of points for each searched shape parameter.
    iterations : int, default 100
        Largest number of generations.
    tolerance : float, default 0.001
        The search ends if E² varies by less than this share within the population.

    Examples
    --------
    >>> fit("paint.binary", "ggx+ggx", solver=DifferentialEvolution())    # doctest: +SKIP
    """

    population: int = 15
    iterations: int = 100
    tolerance: float = 1e-3

    def __post_init__(self) -> None:
        check_number_fields(self)

    def minimise(self, objective: Objective) -> End:
        """Return the end of the search."""
        coordinates = self._explore(objective) if objective.shapes else objective.coordinates
        return LevenbergMarquardt().search_best_ends(objective, coordinates)[0]

    def _explore(self, objective: Objective) -> FloatArray:
        """Return the coordinates (points, shapes) of the last population, the best first."""
        from scipy.optimize import differential_evolution

        first = objective.stages()[0]
        result = differential_evolution(
            lambda u: _find_least_error(first, u.T),
            [(0, 1)] * objective.shapes,
            popsize=self.population,
            maxiter=self.iterations,
            tol=self.tolerance,
            rng=objective.seed,
            vectorized=True,
            updating="deferred",
            polish=False,
            x0=objective.coordinates[0],
        )
        order = np.argsort(result.population_energies, kind="stable")
        return result.population[order]


def _find_least_error(objective: Objective, u: FloatArray) -> FloatArray:
    """Return E² (points,) at coordinates `u` (points, shapes), with nearly the best weights."""
    shapes, problem = objective.shapes, objective.problem
    low = np.tile(problem.least, problem.channels)
    z, least = objective.join(u, problem.estimate_weights(u)), np.full(len(u), np.inf)
    for _ in range(WEIGHT_STEPS):
        here = objective.expand(z)
        gained = (least - here.error) > SETTLED * here.error
        least = np.fmin(least, here.error)
        if not gained.any():
            break
        H, g = here.hessian[:, shapes:, shapes:], here.gradient[:, shapes:]
        z[:, shapes:] += minimise_in_box(H, g, low - z[:, shapes:], np.inf)
    return least
