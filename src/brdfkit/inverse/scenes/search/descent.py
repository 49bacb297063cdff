"""Minimises the difference of pictures over thousands of numbers, such as the texels of textures.

The gradient comes from renderings backwards, and L-BFGS-B [Byrd et al. 1995] steps along it with
fixed samples. Several stages follow each other, each with more and with other samples.
"""

from collections.abc import Callable, Sequence

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.inverse.scenes.problem.parameters import Unknown
from brdfkit.inverse.scenes.problem.unseen_parameters import make_no_effect_error
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search.backward_derivatives import compute_error_and_gradient
from brdfkit.inverse.scenes.search.gauss_newton import Search
from brdfkit.inverse.scenes.search.normal_equations import Residuals

STAGE_SAMPLES = 4, 16, 64  # samples per pixel of each picture in the three stages
SMOOTHNESS_TRIALS = 0.3, 0.03, 0.003, 0.0003, 0.00003  # weights of the smoothness penalty to try
TRIAL_STEPS = 8  # number of L-BFGS-B steps for each weight of the penalty that is tried
HELD_OUT_INTERVAL = 10  # one pixel of this number is held out of the fit, to judge the smoothness


def count_descent_steps(smoothness: float | None, steps: int) -> int:
    """Return how many steps a descent may take in total, for its progress bar."""
    trials = TRIAL_STEPS * len(SMOOTHNESS_TRIALS) if smoothness is None else 0
    return trials + steps * len(STAGE_SAMPLES)


def minimise_by_descent(
    views: Views,
    smoothness: float | None,
    steps: int,
    samples: int,
    seed: int,
    report: Callable[[], object] = lambda: None,
) -> tuple[Search, float]:
    """Return the `Search` from the scene's own values, and the weight of the smoothness penalty.

    `steps` is the limit of L-BFGS-B steps in each stage, `samples` that of samples per pixel.
    Without a `smoothness`, the weight that predicts held-out pixels best is taken. `report()` is
    called after each step. On Ctrl-C `Interrupted` holds the `Search` so far.
    """
    x = views.start
    # The end of the first stage replaces None by residuals before anything reads them
    state = Search(residuals=None)  # type: ignore[arg-type]
    stages = [spp for spp in STAGE_SAMPLES if 2 * spp <= samples] or [max(1, samples // 2)]
    try:
        if smoothness is None:
            x, smoothness = _choose_smoothness(views, x, stages[0], seed, state, report)
        for stage, spp in enumerate(stages):
            own_seed = seed + 10 * stage
            x = _run_lbfgs(views, x, spp, own_seed, views.weights, smoothness, steps, state, report)
            state.residuals = Residuals.render(views, x, 2 * spp, own_seed + 5)
            state.history.append((2 * spp, state.residuals.error))
    except KeyboardInterrupt as stop:
        best = stop.best if isinstance(stop, Interrupted) else x
        state.residuals = Residuals.render(views, best, 2 * stages[0], seed + 5)
        raise Interrupted(state) from None
    return state, smoothness


def _choose_smoothness(
    views: Views, x: FloatArray, spp: int, seed: int, state: Search, report: Callable[[], object]
) -> tuple[FloatArray, float]:
    """Return the coordinates and the weight of the penalty that predict held-out pixels best.

    The trials go from strong to weak smoothness, each from the end of the one before. No trial is
    left out, even if a weaker weight does not improve the prediction: a still weaker one may, as
    for a small light that only then becomes sharp.
    """
    held_out = _choose_held_out_pixels(views, seed)
    fitted, hidden = views.weights * ~held_out[:, None], views.weights * held_out[:, None]
    best, least = (x, SMOOTHNESS_TRIALS[0]), np.inf
    for weight in SMOOTHNESS_TRIALS:
        x = _run_lbfgs(views, x, spp, seed, fitted, weight, TRIAL_STEPS, state, report)
        a, b = (views.render_residuals(x, 4 * spp, seed + 7 + 1000 * half) for half in (0, 1))
        error = float((hidden * a * b).sum())
        if error < least:
            best, least = (x, weight), error
    return best


def _choose_held_out_pixels(views: Views, seed: int) -> BoolArray:
    """Return the mask (pixels,) of held-out pixels, one of every ten of similar brightness.

    So the few pixels of a highlight are never all held out or all fitted.
    """
    brightness = (views.weights * views.target_pixels**2).sum(axis=1)
    order = np.nonzero(views.counted)[0]
    order = order[np.argsort(-brightness[order], kind="stable")]
    first = np.arange(0, len(order), HELD_OUT_INTERVAL)
    chosen = first + np.random.default_rng(seed).integers(0, HELD_OUT_INTERVAL, len(first))
    held_out = np.zeros(len(brightness), bool)
    held_out[order[chosen[chosen < len(order)]]] = True
    return held_out


def _run_lbfgs(
    views: Views,
    x: FloatArray,
    spp: int,
    seed: int,
    weights: FloatArray,
    smoothness: float,
    steps: int,
    state: Search,
    report: Callable[[], object],
) -> FloatArray:
    """Return the coordinates after at most `steps` L-BFGS-B steps from `x` with fixed samples.

    On Ctrl-C `Interrupted` holds the coordinates so far.
    """
    from scipy.optimize import minimize

    last = x

    def compute_loss(x: FloatArray) -> tuple[float, FloatArray]:
        """Return the squared difference of pictures plus the smoothness penalty, and its slope."""
        error, gradient = compute_error_and_gradient(views, x, spp, seed, weights)
        penalty, slope = compute_smoothness_penalty(views.unknowns, views.split_by_unknown(x))
        return error + smoothness * penalty, gradient + smoothness * slope

    def record_step(x: FloatArray) -> None:
        """Remember the coordinates after a step, and report it."""
        nonlocal last
        last = x.copy()
        state.steps += 1
        report()

    _, gradient = compute_loss(x)
    if not gradient.any():
        raise make_no_effect_error(views)
    # The first step of L-BFGS-B is as long as the gradient; the loss is scaled so that the step is
    # 0.1 at most in each coordinate
    scale = 1 / max(abs(gradient).max(), 1e-300)
    try:
        result = minimize(
            lambda x: tuple(scale * 0.1 * part for part in compute_loss(x)),
            x,
            jac=True,
            method="L-BFGS-B",
            bounds=list(zip(views.lower_bounds, views.upper_bounds, strict=True)),
            callback=record_step,
            options={"maxiter": steps, "maxfun": 2 * steps, "maxls": 6, "ftol": 0, "gtol": 0},
        )
    except KeyboardInterrupt:
        raise Interrupted(last) from None
    state.converged = result.status != 1  # SciPy's status is 1 if all steps were used up
    end: FloatArray = result.x
    return end


def compute_smoothness_penalty(
    unknowns: Sequence[Unknown], parts: Sequence[FloatArray]
) -> tuple[float, FloatArray]:
    """Return the smoothness penalty of all tensors, and its gradient (n,).

    The penalty is the mean squared difference of neighbouring texels. `parts` holds the coordinates
    of each unknown. Where there is no upper bound, differences are relative to the mean value at
    the start. Numbers that belong to no tensor have no neighbours and add nothing.
    """
    total, gradient = 0.0, []
    for unknown, part in zip(unknowns, parts, strict=True):
        if unknown.shape:
            unit = 1.0
            if not np.isfinite(unknown.high):
                unit = max(float(np.abs(unknown.to_coordinates(unknown.start)).mean()), 1e-6)
            penalty, slope = _penalise_tensor(part.reshape(unknown.shape) / unit, unknown.wraps)
            total += penalty
            gradient.append(slope.ravel() / unit)
        else:
            gradient.append(np.zeros(len(part)))
    return total, np.concatenate(gradient)


def _penalise_tensor(values: FloatArray, wraps: bool) -> tuple[float, FloatArray]:
    """Return the mean squared difference of neighbours in a tensor, and its gradient.

    `values` is (..., channels). If it `wraps`, the last column is a neighbour of the first one.
    """
    total, gradient = 0.0, np.zeros_like(values)
    for axis in range(values.ndim - 1):
        change = np.roll(values, -1, axis) - values
        if not (wraps and axis == 1):
            np.moveaxis(change, axis, 0)[-1] = 0
        total += float((change**2).sum()) / values.size
        gradient += 2 * (np.roll(change, 1, axis) - change) / values.size
    return total, gradient
