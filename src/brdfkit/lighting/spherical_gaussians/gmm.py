"""Lobes as a mixture fitted to every view, each from its neighbour's, so that they correspond.

The thesis fits views apart from each other, and pictures show where one view's lobes take over from
another's. Here the view along the normal is fitted from several guesses. Every other begins at the
lobes of the view before it, on the same azimuth, moved as facets would move them: their half
vectors stay (`warp`). A few steps then fit them. Lobe k is thus everywhere the same lobe, and
between two views it lies between its places there. [Ergun 2015, section 8.3]
"""

import numpy as np

from brdfkit.core.geometry.directions import rotate_z
from brdfkit.lighting.spherical_gaussians import mixture, warp
from brdfkit.lighting.spherical_gaussians.initial_guess import best_mixture
from brdfkit.lighting.spherical_gaussians.mixture import Mixture

STEPS = 20  # from a neighbour's lobes: more gain little at the views, and nothing between them


def gmm(grid, lobes):
    """(diffuse, weights, axes, κ) of each `OneView` of a `grid`: a list of θ for each of the φ."""
    first = best_mixture(*grid[0][0].samples(), lobes)
    turns = np.arange(len(grid)) * 2 * np.pi / len(grid)
    return [_azimuth(views, _turned(first, -turn)) for views, turn in zip(grid, turns, strict=True)]


def _azimuth(views, lobes):
    """The same for the views of one azimuth, from the `lobes` of the normal outwards."""
    found, before = [], views[0].view
    for one in views:
        start = _seen_from(lobes, before, one.view)
        lobes, _ = mixture.fit(*one.samples(), start, STEPS)
        found.append((one.diffuse, channel_weights(lobes, one), lobes.axes, lobes.kappa))
        before = one.view
    return found


def _turned(lobes, angle):
    """The lobes turned about z."""
    return Mixture(lobes.weights, rotate_z(lobes.axes, angle), lobes.kappa)


def _seen_from(lobes, before, view):
    """The lobes that one view sees as another does, if they are made by facets."""
    halves = warp.to_half_vectors(lobes.axes, lobes.kappa, before)
    return Mixture(lobes.weights, *warp.to_light(*halves, view))


def channel_weights(lobes, one, steps=5):
    """The weights (lobes, channels) of each channel, for lobes that all channels share.

    By the steps of the fit, of the weights alone: they are ≥ 0 and their sum is what the view
    reflects, which least squares would not keep.
    """

    def of_channel(energy):
        weights = lobes.weights * energy.sum()
        for _ in range(steps):
            kept = Mixture(np.maximum(weights, mixture.TINY), lobes.axes, lobes.kappa)
            weights = kept.shares(one.means)[0] @ energy
        return weights

    return np.stack([of_channel(energy) for energy in one.energy.T], axis=1)
