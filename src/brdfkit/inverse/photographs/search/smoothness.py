"""How strongly neighbouring texels are drawn to each other: by the noise and units of numbers."""

import numpy as np

from brdfkit.inverse.photographs.capture.observations import shown_colours
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.inverse.photographs.search.search import equations


def noise_of(numbers, errors, seen):
    """The variance of a relative radiance, from what the texels leave: the median is robust."""
    counted = (seen.weights > 0).sum(axis=(0, 2))
    free = np.maximum(counted - numbers.count, 0.2 * counted)
    return max(float(np.median(errors / np.maximum(free, 1))), 1e-10)


def strengths(numbers, x, seen, noise, tau):
    """σ² / τ² (count,) of each number, in its unit about the rows `x`."""
    return noise / (tau * units_of(numbers, equations(numbers, x, seen).hessian, seen)) ** 2


def units_of(numbers, hessian, seen):
    """The units (count,) of differences, by the texels' Hessians.

    That of a weight is the one by which its lobe alone would be as bright as what is seen: not the
    weight so far, as one that is near 0 would rest there.
    """
    of_weights = slice(0, numbers.shapes.start)
    brightness = np.diagonal(hessian, axis1=1, axis2=2)[:, of_weights]
    counted = (seen.weights > 0).sum(axis=(0, 2))[:, None] / CHANNELS
    alone = np.sqrt(counted / np.maximum(brightness, 1e-12 * counted + 1e-300))
    units, lit = np.ones(numbers.count), shown_colours(seen)
    scale = np.median(alone[counted[:, 0] > 0], axis=0).reshape(-1, CHANNELS)[:, lit].mean(axis=1)
    units[of_weights] = np.repeat(scale, CHANNELS)
    return units
