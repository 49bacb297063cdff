"""Profiles the loss of a fit over one parameter, with all others fitted again at each value."""

from collections.abc import Iterable

import numpy as np

from brdfkit.regression.refitting import Refit

# A profile reaches this number of standard errors, or twice as far, up to so many times, if it does
# not come to the level
REACH, WIDENINGS = 3.0, 6
# Within this number of standard errors the least E² is nearly a parabola
PARABOLA_STEP = 0.3


def follow_profile(
    refit: Refit, parameter: str, middle: float, bound: float, level: float, points: int
) -> tuple[float, list[tuple[float, float]]]:
    """Follow the least loss from the value `middle` of a parameter towards a `bound`.

    Return the value at which the loss crosses the `level`, or the last value, and the pairs (value,
    loss) on the way. `refit`: the `Refit` of the fit; `points`: how many values are tried at once.
    """
    error, width = refit.fit.standard_errors[parameter], abs(bound - middle)
    if width == 0:
        return middle, []
    reach = min(REACH * error, width) if error > 0 else width
    for _ in range(WIDENINGS):
        steps = np.copysign(reach, bound - middle) * np.arange(1, points + 1) / points
        low, high = sorted((middle, bound))
        path = _refit_path(refit, parameter, np.clip(middle + steps, low, high))
        if path[-1][1] > level or reach >= width:
            break
        reach = min(2 * reach, width)
    values, losses = np.array([(middle, refit.fit.loss), *path]).T
    # The root of E² - E²_min is nearly linear in the parameter
    height = np.sqrt(np.maximum(losses**2 - losses[0] ** 2, 0))
    wanted = np.sqrt(level**2 - losses[0] ** 2)
    above = np.flatnonzero(height > wanted)
    if not len(above):
        return float(values[-1]), path
    j = above[0]
    share = (wanted - height[j - 1]) / (height[j] - height[j - 1])
    return float(values[j - 1] + share * (values[j] - values[j - 1])), path


def profile_curvature(refit: Refit, parameter: str, low: float, high: float) -> float | None:
    """Return the rise of the least E² over the square of a parameter's step, near the fit.

    None stands for a parameter without a standard error. `low`, `high`: its bounds.
    """
    middle, error = refit.fit.values[parameter], refit.fit.standard_errors[parameter]
    if not error > 0:
        return None
    steps = [
        s for s in (-PARABOLA_STEP * error, PARABOLA_STEP * error) if low <= middle + s <= high
    ]
    rises = [
        (_refit_path(refit, parameter, [middle + step])[0][1] ** 2 - refit.fit.loss**2) / step**2
        for step in steps
    ]
    return max(float(np.mean(rises)), 0.0) if rises else None


def _refit_path(refit: Refit, parameter: str, values: Iterable[float]) -> list[tuple[float, float]]:
    """Return pairs (value, least loss) at `values` of a parameter, each fit from the last one."""
    shapes, weights, path = refit.fit.values, refit.weights, []
    for value in values:
        problem = refit.make_problem(**{parameter: float(value)})
        shapes, weights, error = refit.search_from(problem, shapes, weights)
        path.append((float(value), float(np.sqrt(error))))
    return path
