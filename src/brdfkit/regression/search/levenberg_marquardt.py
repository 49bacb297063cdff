"""Searches for the parameters with the least squared loss E² by damped Gauss-Newton steps.

[Levenberg 1944]; [Marquardt 1963]. Several searches run side by side, because one kernel evaluates
the current points of all of them faster than one after the other.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.model.parameters import LARGEST_WEIGHT
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.parameter_space import join_point, make_point_limits

# A search is given up if it would stay above the best converged one even if E² fell by this many
# times as much as the next step promises
PATIENCE = 10
# Two ends of searches count as one if their squared losses differ by less than this share
SAME_END = 1e-4
WORST = np.finfo(float).max / 2  # E² of an end that no model can have
# A squared loss below this share of the worst start's counts as 0
ROUNDING = 1e-24
SMALLEST_DAMPING, LARGEST_DAMPING = 1e-15, 1e9


@dataclass(eq=False)
class Search:
    """The result of several searches that ran side by side.

    `ends`: expansion of the squared loss E² about the last point of each search; `corrections`
    (points, n, n): estimates of the terms that its Gauss-Newton Hessians leave out; `converged`:
    whether each search converged (points,); `evaluations`: number of evaluations of E², all
    searches together.
    """

    ends: Expansion
    corrections: np.ndarray
    converged: np.ndarray
    evaluations: int

    def find_best_ends(self, count: int) -> IntArray:
        """Return the indices of the `count` best ends, those with the least squared loss E².

        Of ends with equal E² only one is returned: in a model with two equal lobes, they differ
        only in the order of the lobes. An end with larger weights than a model may have comes last:
        there a lobe is 0 but for rounding.
        """
        largest = np.abs(self.ends.weights).max(axis=(1, 2), initial=0)
        error = np.where(largest <= LARGEST_WEIGHT, self.ends.error, WORST)
        order = np.argsort(error, kind="stable")
        error = error[order]
        new = np.diff(error, prepend=-1) > SAME_END * error
        return order[new][:count]


def levenberg_marquardt(
    expand: Callable[[FloatArray, FloatArray], Expansion],
    u: FloatArray,
    weights: FloatArray,
    weight_limits: FloatArray,
    iterations: int,
    tolerance: float = 1e-6,
    damping: float = 1e-3,
    corrections: FloatArray | None = None,
) -> Search:
    """Search for the least squared loss E² from several start points, and return the `Search`.

    `expand(u, weights)`: a function that returns the `Expansion` of E² about points; `u` (points,
    shapes), `weights` (points, channels, lobes): the start points; `weight_limits` (2, lobes):
    lower and upper bounds of the weights; `iterations`: largest number of steps; `tolerance`: a
    search converges if its next step would lower E² by less than this share; `damping`: damping of
    the first step; `corrections` (points, n, n): those of the search that ended at the start
    points, by default 0.

    A search also converges if its E² is only a rounding error compared with the worst start's. It
    ends without converging if it would not come below a search that has converged. On Ctrl-C
    `Interrupted` is raised with the `Expansion` about the current points.
    """
    now = expand(u.copy(), weights.copy())  # copies, because the search writes into them
    points, shapes = now.u.shape
    channels = weights.shape[1]
    low, high = make_point_limits(shapes, channels, weight_limits)
    correction = np.zeros_like(now.hessian) if corrections is None else corrections.copy()
    dampings, growth, evaluations = np.full(points, damping), np.full(points, 4.0), points
    exact = ROUNDING * now.error.max()
    converged = now.error <= exact
    searching = ~converged
    try:
        for _ in range(iterations):
            # The step goes to the minimum of the damped quadratic function within the bounds
            (rows,) = np.nonzero(searching)
            if not len(rows):
                break
            here = now.select_points(searching)
            H, g = _add_hessian_correction(here.hessian, correction[rows]), here.gradient
            diagonal = H.diagonal(axis1=1, axis2=2)
            floor = 1e-12 * diagonal.max(axis=1, keepdims=True) + 1e-300
            damped = (
                H + np.eye(H.shape[1]) * (dampings[rows, None] * (diagonal + floor))[:, None, :]
            )
            at = join_point(here.u, here.weights)
            step = minimise_in_box(damped, g, low - at, high - at)
            gain = -((2 * g + (H @ step[:, :, None])[:, :, 0]) * step).sum(axis=1)
            # Searches whose step would lower E² too little end; the steps of the others are tried
            over = gain <= tolerance * here.error
            converged[rows[over]] = True
            leader = now.error[converged].min(initial=np.inf)
            over |= here.error - PATIENCE * gain > leader * (1 - 1e-7)
            searching[rows[over]] = False
            rows, here, step, gain = (
                rows[~over],
                here.select_points(~over),
                step[~over],
                gain[~over],
            )
            if not len(rows):
                break
            u = np.clip(here.u + step[:, :shapes], 0, 1)
            if (here.columns.powers < 2).all():
                weights = here.predict_best_weights(u, weight_limits)
            else:
                moved = here.weights.reshape(len(rows), -1) + step[:, shapes:]
                weights = np.clip(moved.reshape(here.weights.shape), *weight_limits)
            trial = expand(u, weights)
            evaluations += len(rows)
            share = (here.error - trial.error) / gain
            dampings[rows] *= np.where(share > 0.75, 0.1, np.where(share > 0.25, 1, growth[rows]))
            dampings = np.maximum(dampings, SMALLEST_DAMPING)
            growth[rows] = np.where(share > 0, 4, 4 * growth[rows])
            searching[rows[dampings[rows] > LARGEST_DAMPING]] = False
            better = trial.error < here.error
            good, bad = rows[better], rows[~better]
            here, trial = here.select_points(better), trial.select_points(better)
            correction[bad] = 0
            correction[good] = _update_hessian_correction(
                correction[good],
                join_point(trial.u, trial.weights) - join_point(here.u, here.weights),
                trial.gradient - here.gradient,
                trial.hessian,
            )
            now.replace_points(good, trial)
            converged |= now.error <= exact
            searching &= ~converged
    except KeyboardInterrupt:
        raise Interrupted(now) from None
    return Search(now, correction, converged, evaluations)


def _update_hessian_correction(
    correction: FloatArray, step: FloatArray, change: FloatArray, hessian: FloatArray
) -> FloatArray:
    """Return better estimates (b, n, n) of the terms that Gauss-Newton Hessians leave out.

    `correction`: the estimates so far; `step` (b, n): last steps of b searches; `change` (b, n):
    changes of the gradient over these steps; `hessian`: Gauss-Newton Hessians after them. The
    update is symmetric and of rank one [Dennis et al. 1981].
    """
    missing = change - ((hessian + correction) @ step[:, :, None])[:, :, 0]
    along = missing * step
    safe = np.abs(along.sum(axis=1)) > 1e-6 * np.abs(along).sum(axis=1)
    factor = np.where(safe, 1 / np.where(safe, along.sum(axis=1), 1), 0)
    return correction + factor[:, None, None] * missing[:, :, None] * missing[:, None, :]


def _add_hessian_correction(hessian: FloatArray, correction: FloatArray) -> FloatArray:
    """Return the Hessians (b, n, n), each plus its correction if it stays positive definite."""
    if not correction.any():
        return hessian
    scale = 1 / np.sqrt(np.maximum(hessian.diagonal(axis1=1, axis2=2), 1e-300))
    both = hessian + correction
    # A parameter without effect has a diagonal entry of 0, so that its scaled entries overflow
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = both * scale[:, :, None] * scale[:, None, :]
    finite = np.asarray(np.isfinite(scaled).all(axis=(1, 2)))
    least = np.linalg.eigvalsh(np.where(finite[:, None, None], scaled, 0))[:, 0]
    return np.where((least > 1e-3)[:, None, None], both, hessian)
