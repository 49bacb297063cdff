"""Draws a small picture of a ball under direct light, with all of its pixels."""

from functools import cache

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.images.ball.half_vectors import Brdf, HalfVectors
from brdfkit.images.ball.normals import find_normals
from brdfkit.images.ball.pixels import draw_directions, sum_pairs

LIGHT = "studio"
# Directions of each pixel that the light draws, and as many that the BRDF draws
DIRECTIONS = 40
# The brightest value of a matt white ball, and its albedo
WHITE = 0.8


def draw_ball(brdf: Brdf, side: int) -> tuple[AnyArray, AnyArray]:
    """Draw the linear picture (side, side, channels) of a ball of a BRDF.

    Also returns how much of each pixel the ball covers (side, side). The light and the exposure are
    the same for all materials.
    """
    x, y, cover = _place_pixels(side)
    values = _compute_radiance(brdf, x[cover > 0], y[cover > 0]) * _compute_exposure()
    picture = np.zeros((side, side, values.shape[1]))
    picture[cover > 0] = values
    return picture, cover


def _place_pixels(side: int) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Return places x, y of pixels in a disc of radius 1, and its cover of each pixel."""
    at = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(at, -at)
    radius = np.hypot(x, y)
    cover = np.clip((1 - radius) * side / 2 + 0.5, 0, 1)
    inside = np.minimum(1, 0.999 / np.maximum(radius, 1e-9))  # move points of the rim inside
    return x * inside, y * inside, cover


def _compute_radiance(brdf: Brdf, x: AnyArray, y: AnyArray) -> AnyArray:
    """Compute the radiance (n, channels) that the ball reflects to the eye at `x`, `y` (n,)."""
    from scipy.stats import qmc

    # All pixels use the same points, so that their errors are alike and the picture has no grain
    points = np.stack([qmc.Halton(3, rng=seed).random(DIRECTIONS) for seed in range(2)])
    for_light, for_brdf = np.repeat(points[:, None], len(x), axis=1)
    normals, half_vectors = find_normals(x, y), HalfVectors(brdf)
    wi, wo, shares = draw_directions(normals, LIGHT, half_vectors, 90.0, for_light, for_brdf)
    return sum_pairs(np.maximum(brdf(wi, wo), 0), shares, 2 * DIRECTIONS)


@cache
def _compute_exposure() -> float:
    """Return the factor of radiances for which a matt white ball has the peak `WHITE`."""
    x, y, cover = _place_pixels(32)
    white = _compute_radiance(
        lambda wi, wo: np.full((len(wi), 1), WHITE / np.pi), x[cover > 0], y[cover > 0]
    )
    return WHITE / np.percentile(white, 99)
