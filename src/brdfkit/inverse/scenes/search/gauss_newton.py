"""Minimises the difference of pictures by Gauss-Newton steps.

A step needs derivatives with respect to all searched numbers. They take most of the time, so the
method takes few steps. The number of samples grows only as far as the noise of rendering demands.
Steps are damped as by [Levenberg 1944] and [Marquardt 1963]. E² is the weighted squared difference
of rendered and target pictures.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import Interrupted
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search.normal_equations import CONFIDENCE, Equations, Residuals
from brdfkit.regression.problem.box_quadratic import minimise_in_box

# Number of rays of the first pictures; fewer are hardly faster, as starting a kernel takes time
INITIAL_RAYS = 2**18
INITIAL_SAMPLES = 8, 128  # fewest and most samples per pixel of the first pictures
GROWTH = 4, 16  # smallest and largest factor by which the number of samples grows between steps
# A search has converged when the squared gradient is below this multiple of its variance, which
# comes from noise
CONVERGED_GRADIENT = 0.1
# Largest share of E² that may be noise of the rendering; this much adds 12 % to the standard errors
QUIET_SHARE = 0.25
# Longest step of a number in which pictures are not linear, as a share of the number's range; for
# the place of a lamp, as a share of its distance, or in radians
NONLINEAR_REACH = 0.25
# Longest step of a lobe's weight without an upper bound, as a multiple of the weight, or of 1 for
# smaller weights
WEIGHT_REACH = 10
FRESH_SAMPLES = 3  # how often new samples are tried if no step reduces E² with the old ones
# Where a trial has more than this multiple of the noise before it, its E² may be smaller by chance
NOISE_JUMP = 2
DAMPING = 1e-2, 1e-6, 1e4  # first, smallest and largest damping of steps
BETTER, WORSE = 0.1, 8  # factors of the damping after a good and after a bad step


@dataclass
class Search:
    """The state of a search for the parameters of a scene.

    residuals : the residuals of the pictures at the current point.
    equations : the Gauss-Newton equations there, if computed.
    steps : how many steps were taken.
    history : the samples per pixel and the squared residual E² of each step.
    converged : whether no step would gain more than the noise.
    stuck : whether a step should gain, but none does, however short.
    worse : whether the search ended worse than the scene's own values, which then replace its end.
    last_step : the last step (n,).
    """

    residuals: Residuals
    equations: Equations | None = None
    steps: int = 0
    history: list[tuple[int, float]] = field(default_factory=list)
    converged: bool = False
    stuck: bool = False
    worse: bool = False
    last_step: FloatArray | None = None


def choose_initial_samples(views: Views) -> int:
    """Return the samples per pixel of the first steps, more for smaller pictures."""
    return int(np.clip(INITIAL_RAYS / len(views.target_pixels), *INITIAL_SAMPLES))


def run_gauss_newton(
    views: Views,
    x: FloatArray,
    steps: int,
    samples: int,
    seed: int,
    report: Callable[[], object] = lambda: None,
) -> Search:
    """Search from the coordinates `x`, with at most `steps` steps and `samples` per pixel.

    `report()` is called after each step. On Ctrl-C `Interrupted` holds the `Search` so far.
    """
    spp, damping, tries = min(choose_initial_samples(views), samples), DAMPING[0], 0
    state = Search(Residuals.render(views, x, spp, seed))
    if state.residuals.error == np.inf:
        raise BrdfkitError("the scene's pictures are not finite where the search begins.")
    state.history.append((spp, state.residuals.error))
    try:
        while True:
            state.equations = equations = Equations.render(views, state.residuals, seed)
            grown = _grow_samples(views, state.residuals, spp, samples)
            free = find_free_numbers(views, state.residuals, equations)
            at_rest = (
                not free.any() or equations.measure_gradient_significance(free) < CONVERGED_GRADIENT
            )
            if at_rest and grown == spp:
                state.converged = True
                break
            if not at_rest:
                if state.steps == steps:
                    break
                step, damping = _find_step(views, state, damping, seed, grown == spp)
                at_rest = step is None or damping >= DAMPING[2]
                if at_rest and grown == spp:
                    # No step reduces E² with these samples, but one may with new samples
                    tries += 1
                    state.stuck = tries > FRESH_SAMPLES
                    if state.stuck:
                        break
            if at_rest or step is None:
                spp, seed, damping = grown, seed + 1, min(damping, DAMPING[0])
                state.residuals = Residuals.render(views, state.residuals.x, spp, seed)
            else:
                state.last_step = step.x - state.residuals.x
                state.residuals, state.steps = step, state.steps + 1
                state.history.append((spp, step.error))
                report()
    except KeyboardInterrupt:
        raise Interrupted(state) from None
    return state


def _find_step(
    views: Views, state: Search, damping: float, seed: int, is_last: bool
) -> tuple[Residuals | None, float]:
    """Return the residuals after a step that reduces E², and the damping for the next step.

    E² is the squared residual. The residuals are None where noise hides whether a step is a gain.
    If `is_last`, the number of samples cannot grow, and a step that should be a gain by the
    equations is taken in spite of the noise.
    """
    here, equations = state.residuals, state.equations
    assert equations is not None
    while True:
        step = solve_step(views, here, equations, damping)
        if is_last and _turns_back(step, state):
            step = step / 2
        trial = Residuals.render(views, here.x + step, 2 * here.spp, seed)
        gain, noise = here.compute_gain(trial)
        if _may_gain_by_noise(here, trial):
            gain = -np.inf
        predicted = equations.predict_gain(step)
        hidden = predicted < CONFIDENCE * noise and gain > -CONFIDENCE * noise
        if gain > 0 or hidden or damping >= DAMPING[2]:
            is_good = hidden or gain > 0.75 * predicted
            damping = max(damping * (BETTER if is_good else 1), DAMPING[1])
            return trial if gain > 0 or (is_last and hidden) else None, damping
        damping *= WORSE


def _turns_back(step: FloatArray, state: Search) -> bool:
    """Return whether a step undoes more than half of the last one, which was too long then.

    Where noise makes the Hessian too small, steps of full length go back and forth without an end.
    """
    if state.last_step is None or state.equations is None:
        return False
    power = state.equations.power
    undone = -float((step * power) @ state.last_step)
    return undone > float((state.last_step * power) @ state.last_step) / 2


def _may_gain_by_noise(here: Residuals, trial: Residuals) -> bool:
    """Return whether the smaller residual of a trial may come from its larger noise alone."""
    return trial.deviation > NOISE_JUMP * here.deviation and trial.bound > here.bound


def solve_step(views: Views, here: Residuals, equations: Equations, damping: float) -> FloatArray:
    """Return the step (n,) that minimises the damped quadratic model within the bounds.

    The step is shorter where the model is no longer a good approximation.
    """
    hessian, scale = equations.scale_hessian()
    damped = hessian + damping * np.eye(len(scale))
    reach = np.where(views.is_nonlinear_share, NONLINEAR_REACH, np.inf)
    reach = np.where(views.is_place, NONLINEAR_REACH * views.scales, reach)
    reach = np.where(views.is_unlimited_weight, WEIGHT_REACH * np.maximum(abs(here.x), 1), reach)
    low = np.maximum(views.lower_bounds - here.x, -reach)
    high = np.minimum(views.upper_bounds - here.x, reach)
    step = minimise_in_box(
        damped[None], (equations.gradient * scale)[None], (low / scale)[None], (high / scale)[None]
    )[0]
    return np.clip(step * scale, low, high)


def find_free_numbers(views: Views, here: Residuals, equations: Equations) -> BoolArray:
    """Return the mask (n,) of numbers that can move downhill without leaving their bounds."""
    x, gradient = here.x, equations.gradient
    at_low = (x <= views.lower_bounds) & (gradient >= 0)
    return ~at_low & ~((x >= views.upper_bounds) & (gradient <= 0))


def _grow_samples(views: Views, here: Residuals, spp: int, samples: int) -> int:
    """Return the next samples per pixel, so many that rendering is quieter than the residuals."""
    noise, error = here.compute_noise(views), max(here.error, 0)
    if noise <= QUIET_SHARE * error:
        return spp
    wanted = spp * noise / (QUIET_SHARE * error) if error else np.inf
    return int(min(samples, spp * np.clip(wanted / spp, *GROWTH)))
