"""How well lights that were held out are predicted, by how much neighbouring texels may differ."""

from dataclasses import replace

import numpy as np

from brdfkit.inverse.photographs.search.coarse_to_fine import coarse_to_fine, finish
from brdfkit.inverse.photographs.search.search import equations
from brdfkit.inverse.photographs.search.smoothness import units_of

TAUS = 1.0, 0.3, 0.1, 0.03  # typical differences of neighbours, of which one is chosen
PATCH = 48  # texels along a side of the part on which that is


def held_out_errors(numbers, seen, noise, report):
    """τ → the RMS relative error of lights that were held out, on a patch in the middle."""
    part = patch(seen)
    lights = np.arange(len(seen.radiance))
    held = lights[1 :: max(2, len(lights) // 3)]
    taught, asked = part.under(np.setdiff1d(lights, held)), part.under(held)
    *_, (start, _, _) = coarse_to_fine(numbers, taught, report)
    units, found = units_of(numbers, equations(numbers, start, taught).hessian, taught), {}
    for tau in TAUS:
        x = finish(numbers, start, taught, noise / (tau * units) ** 2, noise, report)
        left = equations(numbers, x, asked, slopes=False).error
        found[tau] = float(np.sqrt(left.sum() / max(1, (asked.weights > 0).sum())))
    return found


def patch(seen):
    """`Observations` of a patch in the middle."""
    height, width = seen.shape
    rows_, columns = min(height, PATCH), min(width, PATCH)
    top, left = (height - rows_) // 2, (width - columns) // 2
    texel = np.arange(height * width).reshape(height, width)
    inside = seen.at(texel[top : top + rows_, left : left + columns].ravel())
    return replace(inside, shape=(rows_, columns))
