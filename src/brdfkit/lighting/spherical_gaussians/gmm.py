"""Lobes as a mixture fitted to every view, each from its neighbour's, so that they correspond.

The thesis fits views apart from each other, and pictures show where one view's lobes take over from
another's. Here the view along the normal is fitted from several guesses. Every other begins at the
lobes of the view before it, on the same azimuth, moved as facets would move them: their half
vectors stay (`warp`). A few steps then fit them. Lobe k is thus everywhere the same lobe, and
between two views it lies between its places there. [Ergun 2015, section 8.3]
"""

import numpy as np

from brdfkit.core.geometry.directions import normalize, rotate_z, to_angles
from brdfkit.lighting.spherical_gaussians import mixture
from brdfkit.lighting.spherical_gaussians.mixture import Mixture

LEAST = 0.01  # |o·h| of a lobe that is hardly seen: κ stays finite


def beckmann(m):
    """κ = 2 / m² of the facet normals of Beckmann's and Ward's lobe of roughness m."""
    return 2 / np.asarray(m, float) ** 2


def to_light(axes, kappa, view):
    """Axes (..., 3) and κ (...) of lobes of half vectors as those of light, for a `view` (3,)."""
    cosine = axes @ view
    return 2 * cosine[..., None] * axes - view, kappa / (4 * np.maximum(np.abs(cosine), LEAST))


def to_half_vectors(axes, kappa, view):
    """Axes and κ of lobes of light as those of half vectors: the inverse of `to_light`."""
    halves = normalize(axes + view)
    return halves, kappa * 4 * np.maximum(np.abs(halves @ view), LEAST)


def cut_in_intervals(x, weights, n):
    """The thesis's guess: of θ and φ the one of the wider range, cut into n equal intervals.

    The samples `x` (m, 3) of each interval make one lobe. [Ergun 2015, section 8.3]
    """
    angle = max(to_angles(x), key=np.ptp)
    place = (angle - angle.min()) / max(np.ptp(angle), 1e-12) * n
    return mixture.of_clusters(x, weights, np.minimum(place.astype(int), n - 1), n)


def around_samples(x, weights, n, random):
    """n of the samples, drawn by their weights, each with the samples that are nearest to it."""
    drawn = random.choice(len(x), n, p=weights / weights.sum())
    return mixture.of_clusters(x, weights, (x @ x[drawn].T).argmax(axis=1), n)


def best_mixture(x, weights, n, restarts=4):
    """The likeliest mixture of n lobes from the thesis's guess and `restarts` random ones."""
    random = np.random.default_rng(0)
    starts = [cut_in_intervals(x, weights, n)]
    starts += [around_samples(x, weights, n, random) for _ in range(restarts)]
    fits = [mixture.fit(x, weights, start, steps=50) for start in starts]
    best, _ = max(fits, key=lambda found: found[1][-1])
    return mixture.fit(x, weights, best)[0]


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
    halves = to_half_vectors(lobes.axes, lobes.kappa, before)
    return Mixture(lobes.weights, *to_light(*halves, view))


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
