"""Regresses a model on samples: compares starts, searches from the best, weighs down outliers."""

import math
from dataclasses import dataclass

import numpy as np

from brdfkit.fitting.parameter_space import Space
from brdfkit.fitting.problem import Problem
from brdfkit.fitting.robust import robust_search
from brdfkit.fitting.search import slsqp, squared_error_at
from brdfkit.fitting.starting_points import start_points
from brdfkit.jit.threads import in_turn

# If there are more than twice as many samples, the starts are compared, and searched from, on this
# many random ones; one last search uses all samples
PART = 20_000
# A search runs from this many starts, those with the least loss
FOLLOWED = 3


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a regression ended.

    `shapes`: the shape parameters by name; `weights`: (channels, lobes); `loss`: E; `evaluations`:
    how often E was computed; `message`: why the search stopped; `at_bounds`: parameters that ended
    on a bound; `notes`: what else one should know.
    """

    shapes: dict[str, float]
    weights: np.ndarray
    loss: float
    evaluations: int
    message: str
    at_bounds: tuple[str, ...]
    notes: tuple[str, ...]


@in_turn
def regress(
    model,
    samples,
    loss,
    *,
    robust=None,
    starts=16,
    bounds=None,
    fixed=None,
    anisotropic=False,
    seed=0,
    report=None,
):
    """The `Solution` of a model class on valid `Samples` under a `Loss`.

    `robust`: a name in `fitting.robust.WEIGHTS`; `starts`: how many points the search may begin at,
    the model's defaults and points spread over the bounds; `bounds`: (low, high), and `fixed`: a
    value, by shape parameter; `anisotropic`: search the second parameter of an anisotropic model,
    such as ``alpha_v``, too; `seed`: for the start points, and for the random part of a large table
    on which they are compared; `report`: called with (done, total).
    """
    bounds, report = bounds or {}, report or (lambda done, total: None)
    # What is searched: neither fixed nor determined by the measured directions
    given = {n: v for n, v in model.determined(samples).items() if n not in bounds} | (fixed or {})
    space = Space.of(model, bounds, given, anisotropic)
    whole = part = Problem(model, samples, loss)
    if len(samples.wi) > 2 * PART:
        rng = np.random.default_rng(seed)
        rows = np.sort(rng.choice(len(samples.wi), PART, replace=False))
        part = Problem(model, samples.at(rows), loss)

    # Search, first on a part of a large table, then on all of it
    best, evaluations = _search(part, space, model, starts if space.names else 1, seed, report)
    if part is not whole:
        best = slsqp(whole, space, best.u)
        evaluations += best.evaluations
    # Weigh down outliers, from the optimum where all samples count alike
    u, weights, message, notes = best.u, None, best.message, ()
    if robust:
        u, weights, message, notes = _search_robustly(whole, space, best.u, robust, report)
    shapes = {k: float(v) for k, v in (space.values(u) | space.fixed).items()}
    weights = whole.solve(shapes) if weights is None else weights
    return Solution(
        shapes,
        weights,
        whole.scale * math.sqrt(whole.squared_error(shapes, weights)),
        evaluations,
        message,
        _find_at_bounds(space, u, model, weights),
        notes,
    )


def _search(problem, space, model, count, seed, report):
    """The best `Outcome` of searches from the starts with the least loss, and the number of
    evaluations for all starts and searches."""
    points = start_points(space, space.coordinates(model().values), count, seed)
    total = len(points) + min(FOLLOWED, len(points))
    # Compare the starts
    errors = []
    if len(points) > 1:
        for k, u in enumerate(points):
            errors.append(squared_error_at(problem, space, u))
            report(k + 1, total)
        points = points[np.argsort(errors, kind="stable")[:FOLLOWED]]
    # Search from the best
    outcomes = []
    for k, u in enumerate(points):
        outcomes.append(slsqp(problem, space, u))
        report(len(errors) + k + 1, total)
    evaluations = len(errors) + sum(o.evaluations for o in outcomes)
    return min(outcomes, key=lambda o: o.squared_error), evaluations


def _search_robustly(problem, space, u, name, report):
    """The coordinates and weights of a fit with the robust weight `name`, a message and notes."""
    found = robust_search(problem, space, u, name, report)
    light = (found.weights < 0.5).mean()
    note = f"{name}: {light:.1%} of the samples count less than half; the loss is of all"
    settled = "settled" if found.converged else "did not settle"
    weights = found.solution[len(u) :].reshape(problem.channels, -1)
    return found.solution[: len(u)], weights, f"{settled} in {found.passes} passes", (note,)


def _find_at_bounds(space, u, model, weights):
    """The parameters that ended on a bound: weights of 0 in all channels, then shape parameters."""
    shapes = [n for n, v in zip(space.names, u, strict=True) if min(v, 1 - v) < 1e-6]
    black = [n for n, w in zip(model.weights(), weights.T, strict=True) if (w == 0).all()]
    return (*(n for n in black if model.parameters[n].bounds[0] == 0), *shapes)
