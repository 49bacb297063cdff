"""Computes the profile of a fit's loss over one parameter, for confidence limits.

The profile is the least loss at each value of the parameter, with all other parameters fitted again
at this value.
"""

from collections.abc import Iterable

import numpy as np

from brdfkit.regression.refitting import Refit

# Number of standard errors from the fitted value to which a profile extends at first
REACH = 3.0
# Largest number of times that a profile's range is doubled for the loss to reach the wanted level
WIDENINGS = 6
# Number of standard errors from the fitted value within which the squared loss is nearly a parabola
PARABOLA_STEP = 0.3


def follow_profile(
    refit: Refit, parameter: str, middle: float, bound: float, level: float, points: int
) -> tuple[float, list[tuple[float, float]]]:
    """Follow the least loss from the fitted value of a parameter to one of its confidence limits.

    Return the limit, the value at which the loss reaches the `level`, or the last value tried, and
    the pairs (value, loss) on the way. `refit`: the `Refit` of the fit; `middle`: the fitted value;
    `bound`: the bound of the parameter towards which to go; `points`: number of values on the way.
    """
    error, width = refit.fit.standard_errors[parameter], abs(bound - middle)
    if width == 0:
        return middle, []
    reach = min(REACH * error, width) if error > 0 else width
    for _ in range(WIDENINGS):
        steps = np.copysign(reach, bound - middle) * np.arange(1, points + 1) / points
        low, high = sorted((middle, bound))
        path = _refit_along_path(refit, parameter, np.clip(middle + steps, low, high))
        if path[-1][1] > level or reach >= width:
            break
        reach = min(2 * reach, width)
    values, losses = np.array([(middle, refit.fit.loss), *path]).T
    # E² is nearly a parabola, so the root of its rise is nearly linear, and is interpolated
    height = np.sqrt(np.maximum(losses**2 - losses[0] ** 2, 0))
    wanted = np.sqrt(level**2 - losses[0] ** 2)
    above = np.flatnonzero(height > wanted)
    if not len(above):
        return float(values[-1]), path
    j = above[0]
    share = (wanted - height[j - 1]) / (height[j] - height[j - 1])
    return float(values[j - 1] + share * (values[j] - values[j - 1])), path


def estimate_profile_curvature(
    refit: Refit, parameter: str, low: float, high: float
) -> float | None:
    """Return the curvature of the profile at the fitted value of a parameter.

    The curvature is the rise of the least squared loss over the square of a small step; it shows
    whether the standard error of the fit is right. It is None for a parameter without a standard
    error. `low`, `high`: bounds of the parameter.
    """
    middle, error = refit.fit.values[parameter], refit.fit.standard_errors[parameter]
    if not error > 0:
        return None
    steps = [
        s for s in (-PARABOLA_STEP * error, PARABOLA_STEP * error) if low <= middle + s <= high
    ]
    rises = [
        (_refit_along_path(refit, parameter, [middle + step])[0][1] ** 2 - refit.fit.loss**2)
        / step**2
        for step in steps
    ]
    return max(float(np.mean(rises)), 0.0) if rises else None


def _refit_along_path(
    refit: Refit, parameter: str, values: Iterable[float]
) -> list[tuple[float, float]]:
    """Return the pairs (value, least loss) at `values` of a parameter.

    The search at a value starts from the solution at the value before it.
    """
    shapes, weights, path = refit.fit.values, refit.weights, []
    for value in values:
        problem = refit.make_problem(**{parameter: float(value)})
        shapes, weights, error = refit.search_from_start(problem, shapes, weights)
        path.append((float(value), float(np.sqrt(error))))
    return path
