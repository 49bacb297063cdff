"""Gauss-Newton on rendered pictures: few steps, each with all derivatives, and no more samples than
the noise demands. [Levenberg 1944]; [Marquardt 1963]."""

from dataclasses import dataclass, field

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import Interrupted
from brdfkit.inverse.scenes.search.normal_equations import SURE, Equations, Residuals
from brdfkit.regression.problem.box_quadratic import minimise_in_box

RAYS = 2**18  # of the first pictures: rays are cheap beside beginning one
FEW_SAMPLES = 8, 128  # per pixel, the least and the most that they have
GROWTH = 4, 16  # the least and the most by which the samples grow at once
WITHIN = 0.1  # of the variance of the numbers: a step that is shorter gains less than the noise
QUIET = 0.25  # of the error that is left: noise of rendering that is less adds 12 % to the errors
REACH = 0.25  # of the way between bounds: farther off no derivative speaks of what is not linear
STRETCH = 10  # times a model's weight, or 1, how far it goes at once: hidden ones knew no end
FRESH = 3  # times that other samples are tried where none of a step's is a gain
NOISIER = 2  # times as noisy, a trial may have less E² by luck: single samples hit its highlights
DAMPING = 1e-2, 1e-6, 1e4  # the first, the least and the most
BETTER, WORSE = 0.1, 8  # factors of the damping


@dataclass
class Search:
    """Where a search is: `here`, its `Residuals`; `about`, the `Equations` there; how many `steps`
    it took; the `history` of (samples per pixel, E²); `converged`, whether no step would gain more
    than the noise; `stuck`, whether one should, but none, however short, is a gain; `worse`,
    whether all that was found is worse than the scene's own values, which these are."""

    here: Residuals
    about: Equations | None = None
    steps: int = 0
    history: list = field(default_factory=list)
    converged: bool = False
    stuck: bool = False
    worse: bool = False


def few_samples(views):
    """The samples per pixel of the first steps."""
    return int(np.clip(RAYS / len(views.reached), *FEW_SAMPLES))


def search(views, x, steps, samples, seed, report=lambda: None):
    """The `Search` from the coordinates `x` in at most so many `steps`, with at most so many
    `samples` per pixel.

    `report()` is called after each step. On Ctrl-C `Interrupted` has the `Search` so far.
    """
    spp, damping, tries = min(few_samples(views), samples), DAMPING[0], 0
    found = Search(Residuals.at(views, x, spp, seed))
    if found.here.error == np.inf:
        raise BrdfkitError("the scene's pictures are not finite where the search begins.")
    found.history.append((spp, found.here.error))
    try:
        while True:
            found.about = Equations.at(views, found.here, seed)
            grown = _grow(views, found.here, spp, samples)
            at_rest = _is_within_noise(views, found)
            if at_rest and grown == spp:
                found.converged = True
                break
            if not at_rest:
                if found.steps == steps:
                    break
                step, damping = _find_step(views, found, damping, seed, grown == spp)
                at_rest = step is None or damping >= DAMPING[2]
                if at_rest and grown == spp:
                    tries += 1  # of fresh samples: these had no step, however short, that gains
                    found.stuck = tries > FRESH
                    if found.stuck:
                        break
            if at_rest:
                spp, seed, damping = grown, seed + 1, min(damping, DAMPING[0])
                found.here = Residuals.at(views, found.here.x, spp, seed)
            else:
                found.here, found.steps = step, found.steps + 1
                found.history.append((spp, found.here.error))
                report()
    except KeyboardInterrupt:
        raise Interrupted(found) from None
    return found


def _find_step(views, found, damping, seed, last):
    """(the `Residuals` after a step, the damping to go on with); None for the former where noise
    hides whether any is a gain, and these are not the `last` samples.

    With these it is taken all the same: the equations know more of a small gain than two pictures,
    whose samples move with the parameters.
    """
    while True:
        step = step_in_bounds(views, found, damping)
        trial = Residuals.at(views, found.here.x + step, 2 * found.here.spp, seed)
        won, noise = found.here.less(trial)
        if _is_luck(found.here, trial):
            won = -np.inf
        gain = found.about.gain(step)
        hidden = gain < SURE * noise and won > -SURE * noise
        if won > 0 or hidden or damping >= DAMPING[2]:
            well = hidden or won > 0.75 * gain
            damping = max(damping * (BETTER if well else 1), DAMPING[1])
            return trial if won > 0 or (last and hidden) else None, damping
        damping *= WORSE


def _is_luck(here, trial):
    """Whether noise that grew may be all that a trial gains."""
    return trial.deviation > NOISIER * here.deviation and trial.bound > here.bound


def step_in_bounds(views, found, damping):
    """The best step within the bounds by the damped equations."""
    hessian, scale = found.about.scaled()
    damped = hessian + damping * np.eye(len(scale))
    reach = np.where(views.curved, REACH, np.inf)
    far = STRETCH * np.maximum(abs(found.here.x), 1)
    reach = np.where(views.endless, far, reach)
    low = np.maximum(views.least - found.here.x, -reach)
    high = np.minimum(views.most - found.here.x, reach)
    step = minimise_in_box(
        damped[None],
        (found.about.gradient * scale)[None],
        (low / scale)[None],
        (high / scale)[None],
    )[0]
    return np.clip(step * scale, low, high)


def free_of_bounds(views, found):
    """Which numbers (n,) may move downhill: those that are on no bound, or leave it."""
    x, g = found.here.x, found.about.gradient
    return ~((x <= views.least) & (g >= 0)) & ~((x >= views.most) & (g <= 0))


def _is_within_noise(views, found):
    free = free_of_bounds(views, found)
    return not free.any() or found.about.surprise(free) < WITHIN


def _grow(views, here, spp, samples):
    """The samples per pixel that go on: as many as make rendering quieter than what is left."""
    noise, left = here.noise(views), max(here.error, 0)
    if noise <= QUIET * left:
        return spp
    wanted = spp * noise / (QUIET * left) if left else np.inf
    return int(min(samples, spp * np.clip(wanted / spp, *GROWTH)))
