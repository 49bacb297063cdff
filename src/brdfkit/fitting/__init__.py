"""Fits a model to a measured material: `fit`, its result `Fit`, and the `losses`."""

import math
import time

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.evaluating import clamped_share
from brdfkit.fitting.arguments import by_name, pair, whole_number
from brdfkit.fitting.loss import losses as losses
from brdfkit.fitting.problem import Problem
from brdfkit.fitting.result import Fit as Fit
from brdfkit.fitting.robust import WEIGHTS, robust_search
from brdfkit.fitting.search import Outcome, Space, evaluate, slsqp, start_points
from brdfkit.fitting.selection import selected
from brdfkit.model import labels

# The starts are compared on a random part of a large table, the best goes on with all of it
PART = 20_000
# How many of the starts, by their loss, are searched from
FOLLOWED = 3


def fit(
    name,
    data,
    loss="log",
    *,
    robust=None,
    starts=16,
    bounds=None,
    fixed=None,
    anisotropic=None,
    max_angle=80.0,
    seed=0,
    progress=None,
):
    """Fit the model `name`, a label as ``"ggx+ward"`` or a class, to a measured material.

    SQP over the shape parameters from several starts, in double precision; the weights are solved
    inside, per channel, not negative. Spectral data is fitted as linear sRGB.

    `data`: a `Measured`; `loss`: a name in `losses`; `robust`: a name in `fitting.robust.WEIGHTS`,
    ``"bisquare"``, by which outliers lose their say; `starts`: the default and points spread over
    the bounds; `bounds`: other bounds by name, ``{"alpha_u": (0.01, 0.5)}``; `fixed`: shape
    parameters held at a value, ``{"f0": 0.04}``; `anisotropic`: search ``alpha_v`` and its like
    too, which otherwise follow ``alpha_u``: by default where the measurement is anisotropic;
    `max_angle`: samples with an angle at or beyond it [degrees, above 0 to 90] are left out;
    `seed`: of the starts, and of the part of a large table by which they are compared: equal seeds
    give equal fits; `progress`: called with (done, total). Returns a `Fit`.

    Raises `BrdfkitError` for an unknown model, loss or robust weight; for a parameter that is not
    searched, or bounds and values beyond the model's; where `data` was not measured or no sample
    is left; and for a robust fit without more samples than parameters.

    >>> print(fit("ward", load("paint.binary")))    # doctest: +SKIP
    """
    began = time.perf_counter()
    model, loss = labels.model(name), _loss(loss)
    if robust not in (None, *WEIGHTS):
        raise BrdfkitError(f"There is no robust weight {robust!r}; there are {', '.join(WEIGHTS)}.")
    starts, seed = whole_number("starts", starts, least=1), whole_number("seed", seed, least=0)
    bounds, fixed = by_name("bounds", bounds), by_name("fixed", fixed)
    bounds = {n: pair(f"{model.type_name()}: the bounds of {n}", v) for n, v in bounds.items()}
    samples = selected(data, max_angle)
    determined = model.determined(samples)
    given = {n: v for n, v in determined.items() if n not in bounds} | fixed
    anisotropic = data.anisotropic if anisotropic is None else anisotropic
    space = _space(model, bounds, given, anisotropic)
    default = space.coordinates(model().values)

    rng = np.random.default_rng(seed)
    whole = Problem(model, samples, loss)
    part = whole
    if len(samples.wi) > 2 * PART:
        rows = np.sort(rng.choice(len(samples.wi), PART, replace=False))
        part = Problem(model, samples.at(rows), loss)

    report = progress or (lambda done, total: None)
    best, evaluations = _search(part, space, default, starts if space.names else 1, seed, report)
    if part is not whole:
        best = slsqp(whole, space, best.u)
        evaluations += best.evaluations

    u, notes, message = best.u, [], best.message
    if robust:
        found = robust_search(whole, space, u, robust, report)
        u = found.solution[: len(u)]
        light = (found.weights < 0.5).mean()
        notes.append(
            f"{robust}: {light:.1%} of the samples count less than half; the loss is of all"
        )
        settled = "settled" if found.converged else "did not settle"
        message = f"{settled} in {found.passes} passes"
    shapes = {k: float(v) for k, v in (space.values(u) | space.fixed).items()}
    weights = (
        found.solution[len(u) :].reshape(whole.channels, -1) if robust else whole.solve(shapes)
    )
    fitted = model(**shapes, **dict(zip(model.weights(), map(tuple, weights.T), strict=True)))
    return Fit(
        model=fitted,
        data=data.name,
        loss_name=loss.name,
        loss=whole.scale * math.sqrt(whole.error(shapes, weights)),
        samples=len(samples.wi),
        evaluations=evaluations,
        seconds=time.perf_counter() - began,
        message=message,
        at_bounds=_at_bounds(space, u, model, weights),
        notes=(*notes, *_notes(samples, loss, fitted)),
        settings={
            "robust": robust,
            "max_angle": float(max_angle),
            "seed": seed,
            "starts": starts,
            "bounds": bounds,
            "fixed": fixed,
            "anisotropic": anisotropic,
        },
    )


def _search(problem, space, default, count, seed, report) -> tuple[Outcome, int]:
    """The best outcome from the most promising starts, and the evaluations of them all."""
    points = start_points(space, default, count, seed)
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


def _loss(name):
    if not isinstance(name, str) or name not in losses:
        raise BrdfkitError(f"There is no loss {name!r}; there are {', '.join(losses)}.")
    return losses[name]


def _space(model, bounds, fixed, anisotropic):
    """The shape parameters to search, within the model's bounds or narrower ones."""
    shapes = model.shapes(anisotropic)
    for name in (*bounds, *fixed):
        if name not in shapes:
            model.parameter(name)
            raise BrdfkitError(
                f"{model.type_name()}: {name} is not searched, so it can be neither bounded nor "
                f"fixed; searched are {', '.join(shapes) or 'none'}."
            )
    if both := set(bounds) & set(fixed):
        raise BrdfkitError(f"{model.type_name()}: {both.pop()} is bounded and fixed; choose one.")
    for name, (low, high) in bounds.items():
        allowed = model.parameters[name].bounds
        if not allowed[0] <= low < high <= allowed[1]:
            raise BrdfkitError(
                f"{model.type_name()}: the bounds {low:g}..{high:g} of {name} should lie "
                f"within {allowed[0]:g}..{allowed[1]:g}."
            )
    if unknown := [name for name, value in fixed.items() if value is None]:
        raise BrdfkitError(f"{model.type_name()}: {unknown[0]} is fixed at None; give a number.")
    model(**fixed)  # within the bounds
    names = tuple(name for name in shapes if name not in fixed)
    limits = np.array([bounds.get(n, model.parameters[n].bounds) for n in names]).reshape(-1, 2)
    log = np.array([model.parameters[n].log for n in names], bool)
    return Space(names, limits[:, 0], limits[:, 1], log, {k: float(v) for k, v in fixed.items()})


def _notes(samples, loss, fitted):
    notes = []
    negative = (samples.values < 0).mean()
    if negative and not loss.linear:
        notes.append(f"{negative:.1%} of the measured values are negative and count as 0")
    if fitted.signed():
        clamped = clamped_share(fitted)
        notes.append(f"{clamped:.1%} of the hemisphere's direction pairs are clamped at 0")
    return tuple(notes)


def _at_bounds(space, u, model, weights):
    shapes = [n for n, v in zip(space.names, u, strict=True) if min(v, 1 - v) < 1e-6]
    black = [n for n, w in zip(model.weights(), weights.T, strict=True) if (w == 0).all()]
    return (*(n for n in black if model.parameters[n].bounds[0] == 0), *shapes)
