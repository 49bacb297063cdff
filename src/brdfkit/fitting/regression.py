"""A model regressed on samples: starts compared, the best searched from, outliers weighed down."""

import math
from dataclasses import dataclass

import numpy as np

from brdfkit.fitting.problem import Problem
from brdfkit.fitting.robust import robust_search
from brdfkit.fitting.search import evaluate, slsqp
from brdfkit.fitting.space import Space, start_points
from brdfkit.threads import in_turn

# The starts are compared on a random part of a large table, the best goes on with all of it
PART = 20_000
# How many of the starts, by their loss, are searched from
FOLLOWED = 3


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a regression ended.

    `shapes`: the shape parameters by name; `weights`: (channels, lobes); `loss`: E; `evaluations`
    of it; `message`: why the search stopped; `at_bounds`: parameters that ended on a bound;
    `notes`: what else one should know.
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

    `robust`: a name in `fitting.robust.WEIGHTS`; `starts`: the default and points spread over the
    bounds; `bounds`, `fixed`: of shape parameters by name; `anisotropic`: search ``alpha_v`` and
    its like, too; `seed`: of the starts and of the part of a large table by which they are
    compared; `report`: called with (done, total).
    """
    bounds, report = bounds or {}, report or (lambda done, total: None)
    given = {n: v for n, v in model.determined(samples).items() if n not in bounds} | (fixed or {})
    space = Space.of(model, bounds, given, anisotropic)
    whole = part = Problem(model, samples, loss)
    if len(samples.wi) > 2 * PART:
        rng = np.random.default_rng(seed)
        rows = np.sort(rng.choice(len(samples.wi), PART, replace=False))
        part = Problem(model, samples.at(rows), loss)

    best, evaluations = _search(part, space, model, starts if space.names else 1, seed, report)
    if part is not whole:
        best = slsqp(whole, space, best.u)
        evaluations += best.evaluations
    u, weights, message, notes = best.u, None, best.message, ()
    if robust:
        u, weights, message, notes = _robust(whole, space, best.u, robust, report)
    shapes = {k: float(v) for k, v in (space.values(u) | space.fixed).items()}
    weights = whole.solve(shapes) if weights is None else weights
    return Solution(
        shapes,
        weights,
        whole.scale * math.sqrt(whole.error(shapes, weights)),
        evaluations,
        message,
        _at_bounds(space, u, model, weights),
        notes,
    )


def _search(problem, space, model, count, seed, report):
    """The best outcome from the most promising starts, and the evaluations of them all."""
    points = start_points(space, space.coordinates(model().values), count, seed)
    total = len(points) + min(FOLLOWED, len(points))
    errors = []
    if len(points) > 1:
        for k, u in enumerate(points):
            errors.append(evaluate(problem, space, u))
            report(k + 1, total)
        points = points[np.argsort(errors, kind="stable")[:FOLLOWED]]
    outcomes = []
    for k, u in enumerate(points):
        outcomes.append(slsqp(problem, space, u))
        report(len(errors) + k + 1, total)
    evaluations = len(errors) + sum(o.evaluations for o in outcomes)
    return min(outcomes, key=lambda o: o.error), evaluations


def _robust(problem, space, u, name, report):
    """Coordinates and weights by the robust weight `name`, a message and notes."""
    found = robust_search(problem, space, u, name, report)
    light = (found.weights < 0.5).mean()
    note = f"{name}: {light:.1%} of the samples count less than half; the loss is of all"
    settled = "settled" if found.converged else "did not settle"
    weights = found.solution[len(u) :].reshape(problem.channels, -1)
    return found.solution[: len(u)], weights, f"{settled} in {found.passes} passes", (note,)


def _at_bounds(space, u, model, weights):
    shapes = [n for n, v in zip(space.names, u, strict=True) if min(v, 1 - v) < 1e-6]
    black = [n for n, w in zip(model.weights(), weights.T, strict=True) if (w == 0).all()]
    return (*(n for n in black if model.parameters[n].bounds[0] == 0), *shapes)
