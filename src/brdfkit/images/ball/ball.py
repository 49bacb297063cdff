"""A small picture of a ball under direct light, with all of its pixels."""

from functools import cache

import numpy as np

from brdfkit.images.ball.half_vectors import HalfVectors
from brdfkit.images.ball.normals import facing
from brdfkit.images.ball.pixels import add_up, draw_directions

LIGHT = "studio"
# Directions of each pixel, by the light and as many by the BRDF
DIRECTIONS = 40
# A matt white ball of this albedo is as bright as this where it is brightest
WHITE = 0.8


def ball(brdf, side):
    """The picture (side, side, channels) of a ball of a BRDF (wi, wo) → (n, channels), linear, and
    how much of each pixel the ball covers (side, side).

    The light and the exposure are the same for all materials.
    """
    x, y, cover = _disc(side)
    values = _look(brdf, x[cover > 0], y[cover > 0]) * _exposure()
    picture = np.zeros((side, side, values.shape[1]))
    picture[cover > 0] = values
    return picture, cover


def _disc(side):
    """Places x, y of the pixels of a disc of radius 1, and the shares of them that it covers."""
    at = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(at, -at)
    radius = np.hypot(x, y)
    cover = np.clip((1 - radius) * side / 2 + 0.5, 0, 1)
    inside = np.minimum(1, 0.999 / np.maximum(radius, 1e-9))  # at the rim, a point just within
    return x * inside, y * inside, cover


def _look(brdf, x, y):
    """The radiance (n, channels) that is seen of the ball at places `x`, `y` (n,)."""
    from scipy.stats import qmc

    # All pixels by the same points: their errors are alike, and the picture has no grain
    points = np.stack([qmc.Halton(3, rng=seed).random(DIRECTIONS) for seed in range(2)])
    for_light, for_brdf = np.repeat(points[:, None], len(x), axis=1)
    normals, half_vectors = facing(x, y), HalfVectors(brdf)
    wi, wo, shares = draw_directions(normals, LIGHT, half_vectors, 90.0, for_light, for_brdf)
    return add_up(np.maximum(brdf(wi, wo), 0), shares, 2 * DIRECTIONS)


@cache
def _exposure():
    """The factor of radiances by which a matt white ball is as bright as it should be."""
    x, y, cover = _disc(32)
    white = _look(lambda wi, wo: np.full((len(wi), 1), WHITE / np.pi), x[cover > 0], y[cover > 0])
    return WHITE / np.percentile(white, 99)
