"""How far maps are off, by a simulation: the photographs of the maps found, with noise like that of
the real ones, are fitted as these were, and the maps differ by so much from those found.

The noise is what is left of the photographs, each pixel's with a sign by chance: the wild bootstrap
[Wu 1986]. So the renderer, the smoothness and the blur of pixels have their part in the errors,
which the equations of a texel alone do not know.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter

from brdfkit.inverse.photographs.capture.observations import gathered
from brdfkit.inverse.photographs.search.fitting_maps import standard_errors
from brdfkit.inverse.photographs.search.search import equations, search_together
from brdfkit.inverse.photographs.search.through_renderer import STEPS, one_round, rendered

AROUND = 9  # texels along a side, over which a simulated error is the mean
MOST = 5.0  # times its standard error by its equations, by which a texel counts
FEWEST = 0.3  # of the numbers photographed, the share that is free, at least


def simulated_errors(numbers, there, rounds, seen, capture, report=lambda: None):
    """Standard errors (n, count) of the maps of a `Rendered`, which so many `rounds` led to: by the
    equations of each texel, and scaled by what a simulation shows around it."""
    fitted = there.fitted
    signs = np.random.default_rng(0).choice([-1.0, 1.0], capture.pictures.shape[:3])[..., None]
    noise = (capture.pictures - there.pictures) * signs * _spread(numbers, seen, capture)
    pictures = np.where(capture.counted, there.pictures + noise, there.pictures)
    other = replace(capture, pictures=pictures, lost=capture.left_out)
    target = replace(seen, radiance=gathered(other, pictures, seen.shape))
    x = search_together(numbers, fitted.x.copy(), target, fitted.strength, STEPS, report)
    again = replace(fitted, x=x, about=equations(numbers, x, target))
    for done in range(rounds):
        start = rendered(numbers, again, seen, other, report)
        again = one_round(numbers, start, done == 0, seen, other, report)
    errors = standard_errors(numbers, fitted, seen)
    off = np.minimum(np.abs(again.x - fitted.x) / np.maximum(errors, 1e-300), MOST)
    shown = (seen.weights > 0).any(axis=(0, 2)).astype(float)
    around = _sums(off**2 * shown[:, None], seen.shape) / np.maximum(_sums(shown, seen.shape), 1)
    return errors * np.sqrt(np.maximum(1, around))


def _sums(values, shape):
    """Sums (n, count) over the texels around each, of values (n, count) or (n,)."""
    grid = values.reshape(*shape, -1)
    mean = uniform_filter(grid, size=(AROUND, AROUND, 0), mode="constant")
    return AROUND**2 * mean.reshape(len(values), -1)


def _spread(numbers, seen, capture):
    """By how much noise is larger than what is left, a part of which the numbers follow."""
    shown = np.count_nonzero((seen.weights > 0).any(axis=(0, 2)))
    photographed = max(1, np.count_nonzero(capture.counted))
    free = 1 - numbers.count * shown / photographed
    return 1 / np.sqrt(max(free, FEWEST))
