"""Descent along derivatives that go backwards, for thousands of numbers: L-BFGS-B on fixed samples,
[Byrd et al. 1995], with more and fresh samples in each stage."""

import numpy as np

from brdfkit.core.interrupts import Interrupted
from brdfkit.inverse.scenes.problem.tensors import roughness
from brdfkit.inverse.scenes.problem.unseen_parameters import nothing_seen
from brdfkit.inverse.scenes.search.backward_derivatives import error_and_slopes
from brdfkit.inverse.scenes.search.gauss_newton import Search
from brdfkit.inverse.scenes.search.normal_equations import Residuals

SAMPLES = 4, 16, 64  # per pixel and half, of one stage after another
STRENGTHS = 0.3, 0.03, 0.003, 0.0003, 0.00003  # of smoothing, of which held-out pixels choose
FEW = 8  # steps for each of these
HELD_OUT = 10  # of so many pixels, one


def usual_total(smoothing, steps):
    """How many steps a descent may take, for its progress."""
    return (FEW * len(STRENGTHS) if smoothing is None else 0) + steps * len(SAMPLES)


def descend(views, smoothing, steps, samples, seed, report=lambda: None):
    """(the `Search` from the scene's own values, the strength of smoothing).

    `steps`: of L-BFGS-B, at most, in each stage. `report()` is called after each step. On Ctrl-C
    `Interrupted` has the `Search` so far.
    """
    x, found = views.start, Search(None)
    stages = [spp for spp in SAMPLES if 2 * spp <= samples] or [max(1, samples // 2)]
    try:
        if smoothing is None:
            x, smoothing = _choose_smoothing(views, x, stages[0], seed, found, report)
        for stage, spp in enumerate(stages):
            x = _stage(
                views, x, spp, seed + 10 * stage, views.weights, smoothing, steps, found, report
            )
            found.here = Residuals.at(views, x, 2 * spp, seed + 10 * stage + 5)
            found.history.append((2 * spp, found.here.error))
    except KeyboardInterrupt as stop:
        best = stop.best if isinstance(stop, Interrupted) else x
        found.here = Residuals.at(views, best, 2 * stages[0], seed + 5)
        raise Interrupted(found) from None
    return found, smoothing


def _choose_smoothing(views, x, spp, seed, found, report):
    """(coordinates, the strength) that leave the least of the pixels that were held out.

    From strong to weak, each from the end of the one before; all are tried, for what is blurred may
    leave as much until a light is sharp.
    """
    held = _hold_out(views, seed)
    seen, hidden = views.weights * ~held[:, None], views.weights * held[:, None]
    best, least = None, np.inf
    for strength in STRENGTHS:
        x = _stage(views, x, spp, seed, seen, strength, FEW, found, report)
        a, b = (views.residuals(x, 4 * spp, seed + 7 + 1000 * half) for half in (0, 1))
        left = float((hidden * a * b).sum())
        if left < least:
            best, least = (x, strength), left
    return best


def _hold_out(views, seed):
    """Which pixels (pixels,) are held out: one of ten that are next to each other in brightness, so
    that the few of a highlight are not all of one kind."""
    bright = (views.weights * views.reached**2).sum(axis=1)
    order = np.nonzero(views.seen)[0]
    order = order[np.argsort(-bright[order], kind="stable")]
    first = np.arange(0, len(order), HELD_OUT)
    chosen = first + np.random.default_rng(seed).integers(0, HELD_OUT, len(first))
    held = np.zeros(len(bright), bool)
    held[order[chosen[chosen < len(order)]]] = True
    return held


def _stage(views, x, spp, seed, weights, smoothing, steps, found, report):
    """The coordinates after at most so many `steps` from `x`, on the samples of a `seed`."""
    from scipy.optimize import minimize

    last = x

    def loss(x):
        error, slopes = error_and_slopes(views, x, spp, seed, weights)
        rough, uphill = roughness(views.unknowns, views.parts(x))
        return error + smoothing * rough, slopes + smoothing * uphill

    def after(x):
        nonlocal last
        last = x.copy()
        found.steps += 1
        report()

    _, slopes = loss(x)
    if not slopes.any():
        raise nothing_seen(views)
    scale = 1 / max(abs(slopes).max(), 1e-300)  # a first step of L-BFGS is as long as its gradient
    try:
        result = minimize(
            lambda x: tuple(scale * 0.1 * part for part in loss(x)),
            x,
            jac=True,
            method="L-BFGS-B",
            bounds=list(zip(views.least, views.most, strict=True)),
            callback=after,
            options={"maxiter": steps, "maxfun": 2 * steps, "maxls": 6, "ftol": 0, "gtol": 0},
        )
    except KeyboardInterrupt:
        raise Interrupted(last) from None
    found.converged = result.status != 1  # of L-BFGS-B: it ended before its steps did
    return result.x
