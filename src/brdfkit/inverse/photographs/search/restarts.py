"""Texels that ended in a wrong valley begin again, from where others begin and where they ended."""

import numpy as np
from scipy.ndimage import median_filter

from brdfkit.inverse.photographs.maps.residuals import misfits
from brdfkit.inverse.photographs.search.search import equations, search_each
from brdfkit.inverse.photographs.search.starts import WIDTHS, rows

DOUBTFUL = 2  # times the noise, from which a texel begins again
STEPS = 10
WAYS = [(way * a, way * b) for way in (1, 3) for a, b in ((0, 1), (1, 0), (0, -1), (-1, 0))]


def restarted(numbers, x, seen, noise, report):
    """Rows (n, count), those of texels that are not explained searched anew, each for itself."""
    errors = equations(numbers, x, seen, slopes=False).error
    wrong = np.flatnonzero(misfits(errors, noise, seen) > DOUBTFUL)
    if not len(wrong):
        return x
    part, x = seen.at(wrong), x.copy()
    for width in WIDTHS:
        start = rows(numbers, part, width)
        trial, error = search_each(numbers, start, part, steps=STEPS, report=report)
        better = error < errors[wrong]
        x[wrong[better]], errors[wrong[better]] = trial[better], error[better]
    return x


def propagated(numbers, x, seen, report):
    """Rows (n, count): each texel's own, or those of a neighbour that suit it better.

    As [Barnes et al. 2009] hand matches on.
    """
    grid = x.reshape(*seen.shape, -1)
    errors = equations(numbers, x, seen, slopes=False).error
    middle = median_filter(grid, size=(3, 3, 1), mode="nearest")
    for candidate in (middle, *(_moved(grid, *way) for way in WAYS)):
        candidate = candidate.reshape(x.shape)
        there = equations(numbers, candidate, seen, slopes=False).error
        better = there < errors
        x, errors = np.where(better[:, None], candidate, x), np.where(better, there, errors)
        report()
    return x


def _moved(grid, down, right):
    """Rows (height, width, count) of the neighbours that far away; at the edge those of itself."""
    height, width = grid.shape[:2]
    rows_ = np.clip(np.arange(height) + down, 0, height - 1)
    columns = np.clip(np.arange(width) + right, 0, width - 1)
    return grid[rows_][:, columns]
