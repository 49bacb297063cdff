"""Defines `DifferentialEvolution`, a global search by a population of points, for difficult fits.

SciPy's implementation of [Storn & Price 1997] searches the shape parameters. The best weights of
the lobes are computed at each point.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.arguments import check_number_fields
from brdfkit.core.array_types import FloatArray
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.solvers.levenberg_marquardt import LevenbergMarquardt
from brdfkit.regression.solvers.objective import End, Objective

# Largest number of steps towards the best weights of a point; a linear loss needs none
WEIGHT_STEPS = 4
# Steps towards the best weights end if the last lowered E² by less than this share at all points
SETTLED = 1e-3


@dataclass(frozen=True)
class DifferentialEvolution:
    """Differential evolution, a global search by `scipy.optimize.differential_evolution`.

    `LevenbergMarquardt` refines the result. The search takes longer than `LevenbergMarquardt` alone
    and depends less on the start points.

    Parameters
    ----------
    population : int, default 15
        Number of points for each searched shape parameter.
    iterations : int, default 100
        Largest number of generations.
    tolerance : float, default 0.001
        The search ends if the squared loss varies by less than this share within the population.

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
        """Return the `End` with the least squared loss that the search finds."""
        coordinates = (
            self._evolve_population(objective) if objective.shapes else objective.coordinates
        )
        return LevenbergMarquardt().search_best_ends(objective, coordinates)[0]

    def _evolve_population(self, objective: Objective) -> FloatArray:
        """Return the last population of the evolution, coordinates (points, shapes), best first."""
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
    """Return nearly the least squared loss (points,) over all lobe weights, at given coordinates.

    `u` (points, shapes): coordinates of the shape parameters.
    """
    shapes, problem = objective.shapes, objective.problem
    low, high = (np.tile(limits, problem.channels) for limits in problem.weight_limits)
    z, least = objective.join(u, problem.estimate_weights(u)), np.full(len(u), np.inf)
    for _ in range(WEIGHT_STEPS):
        here = objective.expand(z)
        gained = (least - here.error) > SETTLED * here.error
        least = np.fmin(least, here.error)
        if not gained.any():
            break
        H, g = here.hessian[:, shapes:, shapes:], here.gradient[:, shapes:]
        z[:, shapes:] += minimise_in_box(H, g, low - z[:, shapes:], high - z[:, shapes:])
    return least
