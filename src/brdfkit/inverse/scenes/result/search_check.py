"""Checks the end of a search with twice the samples, and with samples that the search did not use.

The check tells whether the end is worse than the scene's own values, and whether the new samples
would move the numbers by more than chance.
"""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.result.conclusions import estimate_certainty, make_refinement
from brdfkit.inverse.scenes.result.refinement import Refinement
from brdfkit.inverse.scenes.result.residual_noise import ResidualNoise
from brdfkit.inverse.scenes.search.gauss_newton import Search, choose_initial_samples, solve_step
from brdfkit.inverse.scenes.search.normal_equations import (
    CONFIDENCE,
    DERIVATIVE_SHARE,
    Equations,
    Residuals,
)

SAMPLE_FACTOR = 2  # the check takes this many times the samples of the search's last step
CHANCE_LIMIT = 4  # a number that moves by more standard errors than this does not move by chance
# A number is poorly sampled if the product of its derivatives in two independent renderings is less
# than this share of their squares
AGREEMENT_SHARE = 0.5
SEED_OFFSET = 7_000  # added to the seed of the search, so that the check has other samples


@dataclass(frozen=True)
class SearchCheck:
    """The comparison of a search's end with a rendering of twice the samples.

    step : the step (n,) that the new equations suggest, in coordinates; 0 for uncertain numbers.
    moves : the size of this step for each number, by name, in standard errors.
    error_change : how much the squared residual E² differs from that of the search, in standard
        deviations.
    poorly_sampled : the names of numbers whose derivatives depend on few light paths.
    """

    step: FloatArray
    moves: dict[str, float]
    error_change: float
    poorly_sampled: tuple[str, ...]

    def average_coordinates(self, views: Views, x: FloatArray) -> FloatArray:
        """Return the mean coordinates (n,) of the search and the check, weighted by their samples.

        Where they differ by more than chance, this is `x`, the end of the search itself.
        """
        if max(self.moves.values(), default=0) > CHANCE_LIMIT:
            return x
        mean = x + SAMPLE_FACTOR / (1 + SAMPLE_FACTOR) * self.step
        return np.clip(mean, views.lower_bounds, views.upper_bounds)

    def describe_differences(self) -> tuple[str, ...]:
        """Return a sentence on how a search with twice the samples differs, if it does."""
        differences = [
            f"{name} moves by {size:.2g} standard errors"
            for name, size in self.moves.items()
            if size > CHANCE_LIMIT
        ]
        if self.error_change > CHANCE_LIMIT:
            differences.append(
                f"the residual differs by {self.error_change:.2g} standard deviations"
            )
        if self.poorly_sampled:
            differences.append(f"few light paths determine {', '.join(self.poorly_sampled)}")
        if not differences:
            return ()
        text = "; ".join(differences)
        return (f"at twice the samples, {text}: take more samples, or other starts",)


def check_search(views: Views, state: Search, seed: int) -> tuple[Search, SearchCheck | None]:
    """Render the end of a search again with twice the samples, and compare it with the search.

    Returns the `Search` with the new pictures and equations, and the comparison. If the end is
    worse than the scene's own values, the returned `Search` is at these values and marked as
    `worse`, and the second result is None.
    """
    spp = 2 * SAMPLE_FACTOR * state.residuals.spp
    there = Residuals.render(views, state.residuals.x, spp, seed + SEED_OFFSET)
    if _is_worse_than_start(views, there, seed):
        own = Residuals.render(views, views.start, spp, seed + SEED_OFFSET)
        return Search(own, None, state.steps, state.history, worse=True), None
    equations = Equations.render(views, there, seed + SEED_OFFSET, DERIVATIVE_SHARE / SAMPLE_FACTOR)
    end = replace(state, residuals=there, equations=equations)
    return end, _compare_with_search(views, state.residuals, end, equations)


def _compare_with_search(
    views: Views, before: Residuals, end: Search, equations: Equations
) -> SearchCheck:
    """Return how the check differs from the search.

    `before` holds the residuals of the search, `end` the search with the residuals of the check,
    and `equations` those of the check.
    """
    here = end.residuals
    certainty = estimate_certainty(views, end, ResidualNoise.measure(views, here))
    errors = certainty.compute_standard_errors()
    certain = np.array([name in errors for name in views.names])
    step = solve_step(views, here, equations, damping=0)
    moved = dict(zip(views.names, np.abs(views.differentiate_values(here.x) * step), strict=True))
    # The search made E² small for its own samples, so with new samples E² may be larger by as much
    # as one more step would gain
    change = abs(here.error - before.error) - max(equations.predict_gain(step), 0)
    deviation = np.hypot(here.deviation, before.deviation)
    share = np.diagonal(equations.hessian) / np.maximum(equations.power, 1e-300)
    return SearchCheck(
        np.where(certain, step, 0),
        {name: float(moved[name] / max(error, 1e-300)) for name, error in errors.items()},
        float(change / max(deviation, 1e-300)),
        tuple(
            name
            for name, part in zip(views.names, share, strict=True)
            if part < AGREEMENT_SHARE and name in errors
        ),
    )


def _is_worse_than_start(views: Views, there: Residuals, seed: int) -> bool:
    """Return whether the squared residual is certainly larger than at the scene's own values.

    `there` holds the residuals at the end of the search. Few samples often suffice to tell that it
    is not worse.
    """
    for spp in (choose_initial_samples(views), 2 * there.spp):
        own = Residuals.render(views, views.start, spp, seed + SEED_OFFSET)
        if own.error == np.inf or own.error - CONFIDENCE * own.deviation > there.bound:
            return False
    return there.bound > own.bound + CONFIDENCE * own.deviation


def make_checked_refinement(
    views: Views, state: Search, search_check: SearchCheck | None, seconds: float
) -> Refinement:
    """Return the `Refinement` of a search and its check, both from `check_search`."""
    if search_check is None:
        return make_refinement(views, state, seconds)
    x = search_check.average_coordinates(views, state.residuals.x)
    return make_refinement(views, state, seconds, x, search_check.describe_differences())
