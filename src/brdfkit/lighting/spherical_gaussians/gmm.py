"""The method `gmm` fits a mixture of lobes to every view, with smooth changes from view to view.

The thesis fits views independently, and its pictures show seams between the lobes of two views.
Here only the view along the normal is fitted from several guesses. The fit of every other view
begins with the lobes of the view before it, at the same azimuth, moved as if they were reflections
by facets whose normals, the half vectors, stay the same. Lobe k of two neighbouring views is thus
the same highlight, and can be interpolated between them. [Ergun 2015, section 8.3]
"""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import normalize, rotate_z, to_angles
from brdfkit.lighting.spherical_gaussians import mixture
from brdfkit.lighting.spherical_gaussians.mixture import Mixture
from brdfkit.lighting.spherical_gaussians.one_view import OneView, ViewLobes

# Lower limit of the cosine between view and half vector, as κ is divided by it where lobes over
# half vectors become lobes over light directions
SMALLEST_COSINE = 0.01
STEPS = 20  # steps of a fit that starts from a neighbouring view; more hardly improve it


def convert_to_light_lobes(
    axes: FloatArray, kappa: FloatArray, view: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Convert lobes over half vectors to lobes over light directions, for a `view` (3,).

    Takes and returns their axes (..., 3) and concentrations κ (...). [Wang et al. 2009]
    """
    cosine = axes @ view
    light = 2 * cosine[..., None] * axes - view
    return light, kappa / (4 * np.maximum(np.abs(cosine), SMALLEST_COSINE))


def convert_to_half_vector_lobes(
    axes: FloatArray, kappa: FloatArray, view: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Convert lobes over light directions to lobes over half vectors, for a `view` (3,).

    It is the inverse of `convert_to_light_lobes`.
    """
    halves = normalize(axes + view)
    return halves, kappa * 4 * np.maximum(np.abs(halves @ view), SMALLEST_COSINE)


def guess_mixture_by_intervals(x: FloatArray, weights: FloatArray, n: int) -> Mixture:
    """Guess a mixture of `n` lobes, to start a fit, from intervals of the polar angle or azimuth.

    The angle of the samples `x` (m, 3) with the larger range is cut into `n` equal intervals, and
    the samples in each give one lobe. [Ergun 2015, section 8.3]
    """
    angle = max(to_angles(x), key=np.ptp)
    place = (angle - angle.min()) / max(np.ptp(angle), 1e-12) * n
    return mixture.make_mixture_from_clusters(x, weights, np.minimum(place.astype(int), n - 1), n)


def guess_mixture_around_samples(
    x: FloatArray, weights: FloatArray, n: int, random: np.random.Generator
) -> Mixture:
    """Guess a mixture of `n` lobes at random, to start a fit.

    `n` of the samples `x` (m, 3) are drawn in proportion to their `weights`, and the samples
    nearest to each of them give one lobe.
    """
    drawn = random.choice(len(x), n, p=weights / weights.sum())
    return mixture.make_mixture_from_clusters(x, weights, (x @ x[drawn].T).argmax(axis=1), n)


def fit_best_mixture(x: FloatArray, weights: FloatArray, n: int, restarts: int = 4) -> Mixture:
    """Fit `n` lobes to samples `x` (m, 3) from several guesses; return the likeliest mixture.

    One guess is by intervals, and `restarts` are random.
    """
    random = np.random.default_rng(0)
    starts = [guess_mixture_by_intervals(x, weights, n)]
    starts += [guess_mixture_around_samples(x, weights, n, random) for _ in range(restarts)]
    fits = [mixture.fit_mixture(x, weights, start, steps=50) for start in starts]
    best, _ = max(fits, key=lambda fit: fit[1][-1])
    return mixture.fit_mixture(x, weights, best)[0]


def fit_gmm_lobes(grid: list[list[OneView]], lobes: int) -> list[list[ViewLobes]]:
    """Fit a mixture of `lobes` lobes to each view of a `grid`.

    For each azimuth, the grid has a list of views by increasing polar angle.
    """
    first = fit_best_mixture(*grid[0][0].samples(), lobes)
    turns = np.arange(len(grid)) * 2 * np.pi / len(grid)
    return [
        _fit_views_of_azimuth(views, _rotate_lobes(first, -turn))
        for views, turn in zip(grid, turns, strict=True)
    ]


def _fit_views_of_azimuth(views: list[OneView], lobes: Mixture) -> list[ViewLobes]:
    """Fit the views of one azimuth, each from its neighbour; `lobes` are those at the normal."""
    results, before = [], views[0].view
    for one in views:
        start = _move_lobes_to_view(lobes, before, one.view)
        lobes, _ = mixture.fit_mixture(*one.samples(), start, STEPS)
        results.append((one.diffuse, fit_channel_weights(lobes, one), lobes.axes, lobes.kappa))
        before = one.view
    return results


def _rotate_lobes(lobes: Mixture, angle: float) -> Mixture:
    """Turn the axes of lobes about z by an `angle` [rad]."""
    return Mixture(lobes.weights, rotate_z(lobes.axes, angle), lobes.kappa)


def _move_lobes_to_view(lobes: Mixture, before: FloatArray, view: FloatArray) -> Mixture:
    """Move lobes from the view `before` to another `view`, so that half vectors stay equal."""
    halves = convert_to_half_vector_lobes(lobes.axes, lobes.kappa, before)
    return Mixture(lobes.weights, *convert_to_light_lobes(*halves, view))


def fit_channel_weights(lobes: Mixture, one: OneView, steps: int = 5) -> FloatArray:
    """Fit the weights (lobes, channels) of lobes; all colour channels share axes and widths.

    It takes steps of expectation maximisation for the weights alone. Unlike least squares, they
    keep the weights ≥ 0, and their sum equal to the light that the view reflects.
    """

    def fit_channel(energy: FloatArray) -> FloatArray:
        weights = lobes.weights * energy.sum()
        for _ in range(steps):
            lit = Mixture(np.maximum(weights, mixture.SMALLEST_WEIGHT), lobes.axes, lobes.kappa)
            weights = lit.lobe_shares(one.mean_directions)[0] @ energy
        return weights

    return np.stack([fit_channel(energy) for energy in one.energy.T], axis=1)
