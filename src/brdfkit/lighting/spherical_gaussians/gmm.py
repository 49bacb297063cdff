"""The method `gmm`: a mixture of lobes for every view, in which lobe k is everywhere the same lobe.

The thesis fits views independently, and pictures show where one view's lobes take over from
another's. Here the view along the normal is fitted from several guesses. Every other view begins
with the lobes of the view before it, at the same azimuth, moved as if facets reflected the light:
their half vectors stay. A few steps then fit them. Between two views, a lobe lies between its
places there. [Ergun 2015, section 8.3]
"""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import normalize, rotate_z, to_angles
from brdfkit.lighting.spherical_gaussians import mixture
from brdfkit.lighting.spherical_gaussians.mixture import Mixture
from brdfkit.lighting.spherical_gaussians.one_view import OneView, ViewLobes

SMALLEST_COSINE = 0.01  # |o·h| of a lobe at a grazing half vector: it keeps κ finite
STEPS = 20  # from a neighbour's lobes: more gain little at the views, and nothing between them


def to_light(
    axes: FloatArray, kappa: FloatArray, view: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Convert lobes of half vectors to lobes of light, for a `view` (3,) [Wang et al. 2009].

    Takes and returns axes (..., 3) and concentrations κ (...).
    """
    cosine = axes @ view
    light = 2 * cosine[..., None] * axes - view
    return light, kappa / (4 * np.maximum(np.abs(cosine), SMALLEST_COSINE))


def to_half_vectors(
    axes: FloatArray, kappa: FloatArray, view: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Convert lobes of light to lobes of half vectors, the inverse of `to_light`."""
    halves = normalize(axes + view)
    return halves, kappa * 4 * np.maximum(np.abs(halves @ view), SMALLEST_COSINE)


def guess_by_intervals(x: FloatArray, weights: FloatArray, n: int) -> Mixture:
    """Return the thesis's guess: cut θ or φ, whichever ranges wider, into `n` equal intervals.

    The samples `x` (m, 3) of each interval make one lobe. [Ergun 2015, section 8.3]
    """
    angle = max(to_angles(x), key=np.ptp)
    place = (angle - angle.min()) / max(np.ptp(angle), 1e-12) * n
    return mixture.from_clusters(x, weights, np.minimum(place.astype(int), n - 1), n)


def guess_around_samples(
    x: FloatArray, weights: FloatArray, n: int, random: np.random.Generator
) -> Mixture:
    """Return a random guess: `n` samples drawn by weight, each with the samples nearest to it."""
    drawn = random.choice(len(x), n, p=weights / weights.sum())
    return mixture.from_clusters(x, weights, (x @ x[drawn].T).argmax(axis=1), n)


def best_mixture(x: FloatArray, weights: FloatArray, n: int, restarts: int = 4) -> Mixture:
    """Fit `n` lobes from the thesis's guess and `restarts` random ones; return the likeliest."""
    random = np.random.default_rng(0)
    starts = [guess_by_intervals(x, weights, n)]
    starts += [guess_around_samples(x, weights, n, random) for _ in range(restarts)]
    fits = [mixture.fit(x, weights, start, steps=50) for start in starts]
    best, _ = max(fits, key=lambda fit: fit[1][-1])
    return mixture.fit(x, weights, best)[0]


def gmm(grid: list[list[OneView]], lobes: int) -> list[list[ViewLobes]]:
    """Fit `lobes` lobes to each view of a `grid`, a list of θ for each of the azimuths φ."""
    first = best_mixture(*grid[0][0].samples(), lobes)
    turns = np.arange(len(grid)) * 2 * np.pi / len(grid)
    return [
        _fit_azimuth(views, _rotate(first, -turn)) for views, turn in zip(grid, turns, strict=True)
    ]


def _fit_azimuth(views: list[OneView], lobes: Mixture) -> list[ViewLobes]:
    """Fit the views of one azimuth, from the `lobes` at the normal outwards."""
    results, before = [], views[0].view
    for one in views:
        start = _move_to_view(lobes, before, one.view)
        lobes, _ = mixture.fit(*one.samples(), start, STEPS)
        results.append((one.diffuse, fit_channel_weights(lobes, one), lobes.axes, lobes.kappa))
        before = one.view
    return results


def _rotate(lobes: Mixture, angle: float) -> Mixture:
    """Turn the lobes about z by an `angle` [rad]."""
    return Mixture(lobes.weights, rotate_z(lobes.axes, angle), lobes.kappa)


def _move_to_view(lobes: Mixture, before: FloatArray, view: FloatArray) -> Mixture:
    """Move lobes from the view `before` to another `view`, as if facets reflected the light."""
    halves = to_half_vectors(lobes.axes, lobes.kappa, before)
    return Mixture(lobes.weights, *to_light(*halves, view))


def fit_channel_weights(lobes: Mixture, one: OneView, steps: int = 5) -> FloatArray:
    """Fit the weights (lobes, channels) of each channel, for lobes that all channels share.

    These are steps of the mixture's fit, for the weights alone. Unlike least squares, they keep the
    weights ≥ 0 and their sum equal to what the view reflects.
    """

    def of_channel(energy: FloatArray) -> FloatArray:
        weights = lobes.weights * energy.sum()
        for _ in range(steps):
            lit = Mixture(np.maximum(weights, mixture.SMALLEST_WEIGHT), lobes.axes, lobes.kappa)
            weights = lit.shares(one.means)[0] @ energy
        return weights

    return np.stack([of_channel(energy) for energy in one.energy.T], axis=1)
