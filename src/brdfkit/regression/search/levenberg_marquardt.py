"""The search for shapes and weights: Gauss-Newton steps within bounds, damped where they mislead.

[Levenberg 1944]; [Marquardt 1963]. Several searches run side by side, their points evaluated in one
kernel.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.interrupts import Interrupted
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.parameter_space import join, limits

# A search goes on while so many times its next gain could bring it below the best one
PATIENCE = 10
# Relative difference of E² below which two ends are one; and E² that is rounding, beside that of a
# start
SAME, ROUNDING = 1e-4, 1e-24
LEAST_DAMPING, MOST_DAMPING = 1e-15, 1e9


@dataclass(eq=False)
class Search:
    """Where searches end: an `Expansion` about the points, which of them `converged` (points,), and
    the number of `evaluations` of all."""

    ends: Expansion
    converged: np.ndarray
    evaluations: int

    def best(self, count):
        """The numbers of the `count` points with the least E² that differ in it."""
        order = np.argsort(self.ends.error, kind="stable")
        error = self.ends.error[order]
        # Equal ends are one end: a sum of equal models has it in each order of its lobes
        new = np.diff(error, prepend=-1) > SAME * error
        return order[new][:count]


def levenberg_marquardt(expand, u, weights, least, iterations, tolerance=1e-6, damping=1e-3):
    """The `Search` from `u` (points, shapes) and `weights` (points, channels, lobes).

    `expand(u, weights)` gives an `Expansion`; `least` (lobes,): the least weights; a search takes
    at most `iterations` steps, ends where the next would lower E² by less than `tolerance` of it,
    or where E² is rounding beside that of the worst start; `damping`: of its first step. A search
    ends, too, that would not come below one that has converged. On Ctrl-C `Interrupted` has the
    `Expansion` about where the searches are.
    """
    now = expand(u.copy(), weights.copy())  # the ends are put into these
    points, shapes = now.u.shape
    channels = weights.shape[1]
    low, high = limits(shapes, channels, least)
    correction = np.zeros_like(now.hessian)
    damping, growth, evaluations = np.full(points, damping), np.full(points, 4.0), points
    exact = ROUNDING * now.error.max()
    converged = now.error <= exact
    searching = ~converged
    try:
        for _ in range(iterations):
            # The best step within the bounds, by the damped quadratic model
            (rows,) = np.nonzero(searching)
            if not len(rows):
                break
            here = now.at(rows)
            H, g = _correct(here.hessian, correction[rows]), here.gradient
            diagonal = H.diagonal(axis1=1, axis2=2)
            floor = 1e-12 * diagonal.max(axis=1, keepdims=True) + 1e-300
            damped = H + np.eye(H.shape[1]) * (damping[rows, None] * (diagonal + floor))[:, None, :]
            at = join(here.u, here.weights)
            step = minimise_in_box(damped, g, low - at, high - at)
            gain = -((2 * g + (H @ step[:, :, None])[:, :, 0]) * step).sum(axis=1)
            # Where nothing is to be gained, the search is over; elsewhere the step is tried
            over = gain <= tolerance * here.error
            converged[rows[over]] = True
            leader = now.error[converged].min(initial=np.inf)
            over |= here.error - PATIENCE * gain > leader * (1 - 1e-7)
            searching[rows[over]] = False
            rows, here, step, gain = rows[~over], here.at(~over), step[~over], gain[~over]
            if not len(rows):
                break
            u = np.clip(here.u + step[:, :shapes], 0, 1)
            if (here.columns.powers == 1).all():
                weights = here.follow(u, least)
            else:
                moved = here.weights.reshape(len(rows), -1) + step[:, shapes:]
                weights = np.maximum(moved.reshape(here.weights.shape), least)
            trial = expand(u, weights)
            evaluations += len(rows)
            share = (here.error - trial.error) / gain
            damping[rows] *= np.where(share > 0.75, 0.1, np.where(share > 0.25, 1, growth[rows]))
            damping = np.maximum(damping, LEAST_DAMPING)
            growth[rows] = np.where(share > 0, 4, 4 * growth[rows])
            searching[rows[damping[rows] > MOST_DAMPING]] = False
            better = trial.error < here.error
            good, bad = rows[better], rows[~better]
            here, trial = here.at(better), trial.at(better)
            correction[bad] = 0
            correction[good] = _secant(
                correction[good],
                join(trial.u, trial.weights) - join(here.u, here.weights),
                trial.gradient - here.gradient,
                trial.hessian,
            )
            now.put(good, trial)
            converged |= now.error <= exact
            searching &= ~converged
    except KeyboardInterrupt:
        raise Interrupted(now) from None
    return Search(now, converged, evaluations)


def _secant(correction, step, change, hessian):
    """The symmetric rank-one update of what the Hessians of Gauss and Newton leave out (b, n, n).

    `step` (b, n), and `change` (b, n), that of the gradient over it. [Dennis et al. 1981]
    """
    missing = change - ((hessian + correction) @ step[:, :, None])[:, :, 0]
    along = missing * step
    safe = np.abs(along.sum(axis=1)) > 1e-6 * np.abs(along).sum(axis=1)
    factor = np.where(safe, 1 / np.where(safe, along.sum(axis=1), 1), 0)
    return correction + factor[:, None, None] * missing[:, :, None] * missing[:, None, :]


def _correct(hessian, correction):
    """The Hessians with their correction, where they remain positive definite."""
    if not correction.any():
        return hessian
    scale = 1 / np.sqrt(np.maximum(hessian.diagonal(axis1=1, axis2=2), 1e-300))
    both = hessian + correction
    with np.errstate(over="ignore", invalid="ignore"):  # where a parameter does nothing
        scaled = both * scale[:, :, None] * scale[:, None, :]
    finite = np.isfinite(scaled).all(axis=(1, 2))
    least = np.linalg.eigvalsh(np.where(finite[:, None, None], scaled, 0))[:, 0]
    return np.where((least > 1e-3)[:, None, None], both, hessian)
