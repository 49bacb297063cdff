"""Regresses a model on samples: searches from many starts, then weighs down outliers."""

import math
from dataclasses import dataclass

import numpy as np

from brdfkit.core.interrupts import Interrupted
from brdfkit.core.jit.threads import in_turn
from brdfkit.model.evaluation import mix_lobes
from brdfkit.regression.certainty import ON_BOUND, Certainty, certify, explain_end
from brdfkit.regression.problem.folding import fold
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.picture_problem import PictureProblem
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import mix_bands
from brdfkit.regression.robust.search import settle
from brdfkit.regression.search.levenberg_marquardt import ROUNDING
from brdfkit.regression.search.light_search import keep_light
from brdfkit.regression.search.multistart import search, with_parts
from brdfkit.regression.search.starting_points import start_points, usual_starts
from brdfkit.regression.solvers import SLSQP, LevenbergMarquardt, Objective
from brdfkit.regression.solvers.constraints import Constraints

# Starts of a search that keeps the light, beside the end of the one that does not
FEW_STARTS = 8


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a regression ended.

    `shapes`: the shape parameters by name; `weights`: (channels, lobes); `loss`: E; `evaluations`:
    how often E was computed; `message`: why the search stopped; `at_bounds`: parameters that ended
    on a bound; `notes`: what else one should know; `certainty`: how certain the parameters are.
    """

    shapes: dict[str, float]
    weights: np.ndarray
    loss: float
    evaluations: int
    message: str
    at_bounds: tuple[str, ...]
    notes: tuple[str, ...]
    certainty: Certainty

    def eval(self, model, samples):
        """The values (n, channels) of the `model` class that was regressed, at `Samples`."""
        return mix_lobes(model(**self.shapes), self.weights.T, samples.wi, samples.wo)


@in_turn
def regress(
    model,
    samples,
    loss,
    *,
    robust=None,
    solver=None,
    constraints=(),
    starts=None,
    bounds=None,
    fixed=None,
    anisotropic=False,
    pixels=None,
    light=None,
    seed=0,
    first=None,
    report=None,
):
    """The `Solution` of a model class on valid `Samples` under a `Loss`, or under a `Picture` on
    `Pixels`, too.

    `robust`: a name in `fitting.robust.WEIGHTS`; `solver`: a `Solver`, by default
    `default_solver`; `constraints`: of `solvers`, or a user's functions of the model;
    `starts`: how many points the search begins at, the model's defaults and points spread over the
    bounds, by default `usual_starts`; `light`: the `Light` of the data, which a fit without
    `robust` and `constraints` keeps; `bounds`: (low, high), and `fixed`: a value, by shape
    parameter; `anisotropic`: search the second parameter of an anisotropic model, such as
    ``alpha_v``, too; `seed`: for the start points, and for the parts of many samples by which they
    are compared; `first`: the shape parameters of the first of these points, by default the
    model's; `report`: called with (done, total). On Ctrl-C `Interrupted` has the best `Solution` so
    far.
    """
    bounds, report = bounds or {}, report or (lambda done, total: None)
    space = Space.on(samples, model, bounds, fixed or {}, anisotropic)
    rng = np.random.default_rng(seed)
    if pixels is None:
        whole = Problem(model, samples, loss, space)
        folded = fold(whole)
        problems = [folded] if folded else with_parts(whole, rng)
    else:
        whole = PictureProblem.of(model, samples, loss, space, pixels, rng)
        problems = [whole.few(rng), whole]
    default = space.coordinates(first or model().values)
    points = start_points(space, default, starts or usual_starts(len(space.names)), seed)
    counted = 0
    if len(whole.groups) > 1:  # compare the starts on few channels
        bands = with_parts(whole.on(mix_bands(samples)), rng)
        try:
            found, _, counted = search(bands, points, report)
        except Interrupted:  # of a fit to all channels nothing is known yet
            raise KeyboardInterrupt from None
        points = found.u
    limits = Constraints(constraints, whole) if constraints else None
    objective = Objective.of(problems, points, seed, report, limits)
    solver = solver or default_solver(constraints)
    stopped = False
    try:
        end = objective.require_end(solver.minimise(objective))
    except KeyboardInterrupt as stop:
        # With constraints, what was seen so far need not meet them
        best = None if limits else objective.best_so_far(getattr(stop, "best", None))
        if best is None:
            raise
        end, stopped = best, True
    (u, weights), passes = objective.split(end.point[None]), None
    error, message, notes = end.error, end.message, limits.notes(end.point) if limits else ()
    if message != "converged" and error <= ROUNDING * whole.black.sum():
        message = "converged"  # a model that meets the data: the search went on in rounding
    # Weigh down outliers, from the optimum where all samples count alike
    if robust and not stopped:
        try:
            u, weights, message, notes, passes = settle(whole, u, weights, robust, rng, report)
        except Interrupted as stop:
            u, weights, stopped = stop.best.point.u, stop.best.point.weights, True
        error = whole.sums(u, weights, curvature=False).error[0]
    elif light is not None and not (limits or stopped or pixels):
        try:
            kept = keep_light(whole, u, weights, light, points[:FEW_STARTS], rng)
        except KeyboardInterrupt:
            kept, stopped = None, True
        if kept is not None:
            u, weights, notes = kept[0], kept[1], (*notes, kept[2])
            error = whole.sums(u, weights, curvature=False).error[0]
    certainty = certify(whole, u, weights, passes, rng)
    if pixels is not None:
        certainty = certainty.without_errors(samples.values.size)
    message = "interrupted: the best so far" if stopped else explain_end(certainty) or message
    found = Solution(
        space.values(u[0]),
        weights[0],
        math.sqrt(error),
        counted + objective.count(),
        message,
        _find_at_bounds(space, u[0], model, weights[0]),
        notes,
        certainty,
    )
    if stopped:
        raise Interrupted(found)
    return found


def default_solver(constraints):
    """The solver of a fit that names none."""
    return SLSQP() if constraints else LevenbergMarquardt()


def _find_at_bounds(space, u, model, weights):
    """The parameters that ended on a bound: weights of 0 in all channels, then shape parameters."""
    shapes = [n for n, v in zip(space.names, u, strict=True) if min(v, 1 - v) < ON_BOUND]
    black = [n for n, w in zip(model.weights(), weights.T, strict=True) if (w == 0).all()]
    return (*(n for n in black if model.parameters[n].bounds[0] == 0), *shapes)
