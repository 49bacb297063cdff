"""Follows the least loss over one parameter, from the end of a fit to where it is too large."""

import numpy as np

# So many standard errors are followed, and twice as many again where they do not reach the level
REACH, WIDENINGS = 3.0, 6
# A step of so many standard errors, within which the least E² is nearly a parabola
NEAR = 0.3


def follow(again, parameter, middle, bound, level, points):
    """Where the profile crosses the `level` on the side of a `bound`, and (value, loss) pairs on
    the way."""
    error, width = again.fit.standard_errors[parameter], abs(bound - middle)
    if width == 0:
        return middle, []
    reach = min(REACH * error, width) if error > 0 else width
    for _ in range(WIDENINGS):
        steps = np.copysign(reach, bound - middle) * np.arange(1, points + 1) / points
        path = _descend(again, parameter, np.clip(middle + steps, *sorted((middle, bound))))
        if path[-1][1] > level or reach >= width:
            break
        reach = min(2 * reach, width)
    values, losses = np.array([(middle, again.fit.loss), *path]).T
    # The root of E² - E²_min is nearly linear in the parameter
    height = np.sqrt(np.maximum(losses**2 - losses[0] ** 2, 0))
    wanted = np.sqrt(level**2 - losses[0] ** 2)
    above = np.flatnonzero(height > wanted)
    if not len(above):
        return float(values[-1]), path
    j = above[0]
    share = (wanted - height[j - 1]) / (height[j] - height[j - 1])
    return float(values[j - 1] + share * (values[j] - values[j - 1])), path


def curvature(again, parameter, low, high):
    """The rise of the least E² over the square of a parameter's step, near the fit; None where the
    parameter has no standard error."""
    middle, error = again.fit.values[parameter], again.fit.standard_errors[parameter]
    if not error > 0:
        return None
    steps = [s for s in (-NEAR * error, NEAR * error) if low <= middle + s <= high]
    rises = [
        (_descend(again, parameter, [middle + step])[0][1] ** 2 - again.fit.loss**2) / step**2
        for step in steps
    ]
    return max(float(np.mean(rises)), 0.0) if rises else None


def _descend(again, parameter, values):
    """(value, least loss) pairs at `values` of a parameter, each from the end before."""
    shapes, weights, path = again.fit.values, again.weights, []
    for value in values:
        problem = again.problem(**{parameter: float(value)})
        shapes, weights, error = again.descend(problem, shapes, weights)
        path.append((float(value), float(np.sqrt(error))))
    return path
