"""Draws a thumbnail of a ball under direct light: all pixels of a small picture."""

from functools import cache

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.quasi_random import draw_halton_points
from brdfkit.images.ball.half_vectors import Brdf, HalfVectors
from brdfkit.images.ball.normals import find_normals
from brdfkit.images.ball.pixels import draw_directions, sum_pairs

LIGHT = "studio"
DIRECTIONS = 40  # directions per pixel drawn by the light, and as many drawn by the BRDF
WHITE = 0.8  # albedo of a matt white ball, and the brightest value in its picture


def draw_ball(brdf: Brdf, side: int) -> tuple[AnyArray, AnyArray]:
    """Draw a picture of a ball with this BRDF, `side` pixels wide and high.

    Returns the linear picture (side, side, channels), and the share of each pixel that the ball
    covers (side, side). The light and the exposure are the same for all materials.
    """
    x, y, cover = _place_pixels(side)
    values = _compute_radiance(brdf, x[cover > 0], y[cover > 0]) * compute_exposure()
    picture = np.zeros((side, side, values.shape[1]))
    picture[cover > 0] = values
    return picture, cover


def _place_pixels(side: int) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Return the pixels' coordinates x, y in the unit disc, and the share of each in the disc."""
    centres = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(centres, -centres)
    radius = np.hypot(x, y)
    cover = np.clip((1 - radius) * side / 2 + 0.5, 0, 1)
    inside = np.minimum(1, 0.999 / np.maximum(radius, 1e-9))  # moves pixels at the rim inside
    return x * inside, y * inside, cover


def _compute_radiance(brdf: Brdf, x: AnyArray, y: AnyArray) -> AnyArray:
    """Compute the radiance (n, channels) of the ball at the coordinates `x`, `y` (n,)."""
    # All pixels use the same random points, so that their errors are alike and show no grain
    points = np.stack([draw_halton_points(DIRECTIONS, 3, seed) for seed in range(2)])
    for_light, for_brdf = np.repeat(points[:, None], len(x), axis=1)
    normals, half_vectors = find_normals(x, y), HalfVectors(brdf)
    wi, wo, shares = draw_directions(normals, LIGHT, half_vectors, 90.0, for_light, for_brdf)
    return sum_pairs(np.maximum(brdf(wi, wo), 0), shares, 2 * DIRECTIONS)


@cache
def compute_exposure() -> float:
    """Return the exposure of all pictures, which gives a matt white ball the peak `WHITE`."""
    x, y, cover = _place_pixels(32)
    white = _compute_radiance(
        lambda wi, wo: np.full((len(wi), 1), WHITE / np.pi), x[cover > 0], y[cover > 0]
    )
    return WHITE / np.percentile(white, 99)
