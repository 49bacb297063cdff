"""Regresses a model on samples: searches its parameters, and estimates how certain they are.

After a search from many starts, further steps reduce the weight of outliers or correct the albedo.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.images.ball import Pixels
from brdfkit.model import Model
from brdfkit.model.evaluation import mix_lobes
from brdfkit.model.samples import Samples
from brdfkit.regression.albedo import TargetAlbedo
from brdfkit.regression.certainty import (
    ON_BOUND,
    Certainty,
    compute_certainty,
)
from brdfkit.regression.problem.folding import fold_problem
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.pixel_problem import PictureProblem
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import average_to_bands
from brdfkit.regression.robust.search import search_robust_solution
from brdfkit.regression.search.albedo_search import correct_albedo
from brdfkit.regression.search.levenberg_marquardt import ROUNDING
from brdfkit.regression.search.multistart import (
    choose_start_count,
    make_part_problems,
    make_start_points,
    search_from_starts,
)
from brdfkit.regression.solvers import SLSQP, LevenbergMarquardt, Objective
from brdfkit.regression.solvers.constraints import Constraints

# Number of start points of the search that corrects an albedo, besides the wrong solution
CORRECTION_STARTS = 8


@dataclass(frozen=True, eq=False)
class Solution:
    """The result of a regression: the parameters of the model, and how they were found.

    `shapes`: shape parameters by name; `weights`: weights of the lobes (channels, lobes); `loss`:
    the loss E at the solution; `evaluations`: number of evaluations of E; `message`: the reason why
    the search stopped; `at_bounds`: names of parameters that ended on a bound; `notes`: sentences
    on the search; `certainty`: covariance of the parameters.
    """

    shapes: dict[str, float]
    weights: np.ndarray
    loss: float
    evaluations: int
    message: str
    at_bounds: tuple[str, ...]
    notes: tuple[str, ...]
    certainty: Certainty

    def eval(self, model: type[Model], samples: Samples) -> FloatArray:
        """Return the fitted BRDF (n, channels) at the directions of samples; `model`: its class."""
        return mix_lobes(model(**self.shapes), self.weights.T, samples.wi, samples.wo)


@in_turn
def regress(
    model: type[Model],
    samples: Samples,
    loss: Any,
    *,
    robust: str | None = None,
    solver: Any = None,
    constraints: Iterable[Any] = (),
    starts: int | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    anisotropic: bool = False,
    pixels: Pixels | None = None,
    target_albedo: TargetAlbedo | None = None,
    seed: int = 0,
    first: Mapping[str, Any] | None = None,
    report: Progress | None = None,
) -> Solution:
    """Fit a `model` class to valid `samples` under a `loss`, and return the `Solution`.

    `robust`: name of a weight function in `robust.reweighting.WEIGHTS` that reduces outliers.
    `solver`: a `Solver`, by default the result of `choose_solver`.
    `constraints`: constraints of `solvers`, or a user's functions of the model.
    `starts`: number of start points, by default the result of `choose_start_count`.
    `bounds`: (low, high) by shape parameter.
    `fixed`: a value by shape parameter that is not searched.
    `anisotropic`: whether to search the second roughness of an anisotropic model, as ``alpha_v``.
    `pixels`: pixels to which the model is fitted, too, under the loss `Picture`.
    `target_albedo`: the albedo of the data, to correct a fit without `robust` and `constraints`.
    `seed`: seed of the start points and of the choice among many samples.
    `first`: shape parameters of the first start point by name, by default the model's defaults.
    `report`: a function that is called with the steps done and the number of all steps.

    On Ctrl-C `Interrupted` is raised with the best `Solution` so far.
    """
    bounds, report = bounds or {}, report or (lambda done, total: None)
    space = Space.for_samples(samples, model, bounds, fixed or {}, anisotropic)
    rng = np.random.default_rng(seed)
    if pixels is None:
        whole = Problem(model, samples, loss, space)
        folded = fold_problem(whole)
        problems: list[Any] = [folded] if folded else list(make_part_problems(whole, rng))
    else:
        whole = PictureProblem.for_fit(model, samples, loss, space, pixels, rng)
        problems = [whole.make_smaller(rng), whole]
    default = space.to_coordinates(first or model().values)
    points = make_start_points(default, starts or choose_start_count(len(space.names)), seed)
    evaluations = 0
    if len(whole.groups) > 1:  # a spectral fit: means of a few bands suffice to choose the starts
        bands = make_part_problems(whole.with_samples(average_to_bands(samples)), rng)
        try:
            ends, _, evaluations = search_from_starts(bands, points, report)
        except Interrupted:  # so far only the bands are fitted, not all channels
            raise KeyboardInterrupt from None
        points = ends.u
    limits = Constraints(constraints, whole) if constraints else None
    objective = Objective.from_problems(problems, points, seed, report, limits)
    solver = solver or choose_solver(constraints)
    stopped = False
    try:
        end = objective.require_end(solver.minimise(objective))
    except KeyboardInterrupt as stop:
        # The points evaluated so far may violate the constraints, so none of them is a result
        best = None if limits else objective.best_so_far(getattr(stop, "best", None))
        if best is None:
            raise
        end, stopped = best, True
    (u, weights), passes = objective.split(end.point[None]), None
    error, message, notes = end.error, end.message, limits.write_notes(end.point) if limits else ()
    if message != "converged" and error <= ROUNDING * whole.black_squares.sum():
        message = "converged"  # E² is a rounding error: the model meets the data exactly
    # The robust search starts from the optimum of the plain loss, in which outliers count fully
    if robust and not stopped:
        try:
            u, weights, message, notes, passes = search_robust_solution(
                whole, u, weights, robust, rng, report
            )
        except Interrupted as stop:
            u, weights, stopped = stop.best.point.u, stop.best.point.weights, True
        error = whole.compute_sums(u, weights, curvature=False).error[0]
    elif target_albedo is not None and not (limits or stopped or pixels):
        try:
            corrected = correct_albedo(
                whole, u, weights, target_albedo, points[:CORRECTION_STARTS], rng
            )
        except KeyboardInterrupt:
            corrected, stopped = None, True
        if corrected is not None:
            u, weights, notes = corrected[0], corrected[1], (*notes, corrected[2])
            error = whole.compute_sums(u, weights, curvature=False).error[0]
    certainty = compute_certainty(whole, u, weights, passes, rng)
    if pixels is not None:
        certainty = certainty.without_standard_errors(samples.values.size)
    message = (
        "interrupted: the best so far"
        if stopped
        else _explain_undetermined_parameters(certainty) or message
    )
    solution = Solution(
        space.to_named_values(u[0]),
        weights[0],
        math.sqrt(error),
        evaluations + objective.count(),
        message,
        _find_parameters_at_bounds(space, u[0], model, weights[0]),
        notes,
        certainty,
    )
    if stopped:
        raise Interrupted(solution)
    return solution


def _explain_undetermined_parameters(certainty: Certainty) -> str | None:
    """Return the message of a fit whose data do not determine all parameters, otherwise None."""
    numbers, parameters = certainty.numbers, certainty.parameters
    if numbers < parameters:
        return f"underdetermined: the values are some of many that meet the {numbers} numbers"
    if numbers == parameters:
        return f"as many numbers as parameters, {numbers}: nothing tells how certain the values are"
    if certainty.undetermined:
        return "ended, and not all values are determined"
    return None


def choose_solver(constraints: Iterable[Any]) -> Any:
    """Return the default solver: `SLSQP` with constraints, `LevenbergMarquardt` without."""
    return SLSQP() if constraints else LevenbergMarquardt()


def _find_parameters_at_bounds(
    space: Space, u: FloatArray, model: type[Model], weights: FloatArray
) -> tuple[str, ...]:
    """Return the names of parameters that ended on a bound.

    First come weights that are 0 in all channels, or at their upper bound in one, then shape
    parameters; `u` (shapes,) and `weights` (channels, lobes): the solution.
    """
    shapes = [n for n, v in zip(space.names, u, strict=True) if min(v, 1 - v) < ON_BOUND]
    bounds = {name: model.parameters[name].bounds for name in model.weights()}
    at_bounds = [
        name
        for (name, (low, high)), own in zip(bounds.items(), weights.T, strict=True)
        if (low == 0 and (own == 0).all()) or (own >= high).any()
    ]
    return (*at_bounds, *shapes)
