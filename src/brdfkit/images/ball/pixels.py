"""Pixels of pictures of a ball, under direct light: I_p = Σ_s a_s f(wi_s, wo_s).

The directions wi are drawn once, by the light and by the material, and weighted by the balance
heuristic [Veach & Guibas 1995]. So a picture is linear in the BRDF f, and so are its derivatives.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.images.ball.half_vectors import HalfVectors
from brdfkit.images.ball.lights import LIGHTS, get_sampling
from brdfkit.images.ball.normals import VIEW, draw_normals, make_frames

# Pixels of all pictures; directions of each, by the light and as many by the material
PIXELS, DIRECTIONS = 960, 64
# The share of a picture that is brighter than 1
BRIGHTER = 0.01


@dataclass(frozen=True, eq=False)
class Pixels:
    """Pixels, each of as many `pairs` of directions, one pixel after the other.

    `wi`, `wo`: (pixels · pairs, 3); `shares`: a (pixels · pairs,); `values`: (pixels, channels),
    those of the measured material; `weights` (pixels,): how much of all pictures a pixel stands
    for, 1 in the mean. Any first pixels are spread over all pictures and each ball.
    """

    wi: np.ndarray
    wo: np.ndarray
    shares: np.ndarray
    values: np.ndarray
    weights: np.ndarray
    pairs: int

    def look(self, brdf):
        """The pixels (pixels, channels) of another BRDF (wi, wo) → (n, channels)."""
        return sum_pairs(brdf(self.wi, self.wo), self.shares, self.pairs)

    def take_first(self, count):
        """The first `count` pixels."""
        return self.at(slice(count))

    def at(self, rows):
        """The pixels of these `rows` (a slice, a mask or indices)."""
        arrays = (self.wi, self.wo, self.shares)
        by_pixel = (a.reshape(-1, self.pairs, *a.shape[1:])[rows] for a in arrays)
        pairs = (a.reshape(-1, *a.shape[2:]) for a in by_pixel)
        return Pixels(*pairs, self.values[rows], self.weights[rows], self.pairs)


def draw_pixels(lights, brdf, max_angle=90.0, seed=0, pixels=PIXELS, directions=DIRECTIONS):
    """The `Pixels` of a ball of a BRDF (wi, wo) → (n, channels), one picture for each of the
    `lights`, names in `LIGHTS`.

    Directions at or beyond `max_angle` [degrees] to the normal do not count; `pixels`: of all
    pictures; `directions`: of each pixel, by the light and as many by the BRDF.
    """
    rng, half_vectors = np.random.default_rng(seed), HalfVectors(brdf)
    count = -(-pixels // len(lights))
    pictures = [
        _draw_picture(name, brdf, half_vectors, max_angle, rng, count, directions)
        for name in lights
    ]
    # One pixel of each picture, then the next
    arrays = (np.stack(parts, axis=1) for parts in zip(*pictures, strict=True))
    wi, wo, shares, values, weights = (a.reshape(-1, *a.shape[2:]) for a in arrays)
    pairs = wi.reshape(-1, 3), wo.reshape(-1, 3), shares.ravel()
    return Pixels(*pairs, values, weights, 2 * directions)


def _draw_picture(name, brdf, half_vectors, max_angle, rng, pixels, directions):
    """Of one picture, wi and wo (pixels, pairs, 3), shares (pixels, pairs), values and weights."""
    light, pairs = get_sampling(name), 2 * directions
    normals, weights = draw_normals(pixels, light, half_vectors, rng)
    points = [_stratify(rng, pixels, directions) for _ in range(2)]
    wi, wo, shares = draw_directions(normals, name, half_vectors, max_angle, *points)
    values = sum_pairs(brdf(wi, wo), shares, pairs)
    exposure = 1 / (_find_white(values.max(axis=1), weights) or 1.0)
    shape = pixels, pairs
    return (
        wi.reshape(*shape, 3),
        wo.reshape(*shape, 3),
        exposure * shares.reshape(shape),
        exposure * values,
        weights,
    )


def draw_directions(normals, name, half_vectors, max_angle, for_light, for_brdf):
    """Pairs wi, wo (n · pairs, 3) at points of `normals` (n, 3) under the light called `name`,
    and their shares (n · pairs,) in the radiance that is seen.

    `for_light`, `for_brdf`: points (n, directions, 3) of the unit cube, by which each is drawn.
    """
    light, shape = get_sampling(name), for_light.shape
    frames, directions = make_frames(normals), shape[1]
    wo = np.repeat((frames @ VIEW)[:, None], 2 * directions, axis=1)
    # Directions in each normal's frame: drawn by the light in the world, and by the BRDF there
    by_light = light.sample(for_light.reshape(-1, 3)).reshape(shape)
    by_light = by_light @ frames.transpose(0, 2, 1)
    by_brdf = half_vectors.sample(wo[:, :directions].reshape(-1, 3), for_brdf.reshape(-1, 3))
    wi = np.concatenate([by_light, by_brdf.reshape(shape)], axis=1)
    world = (wi @ frames).reshape(-1, 3)
    wi, wo = wi.reshape(-1, 3), wo.reshape(-1, 3)
    density = directions * (light.pdf(world) + half_vectors.pdf(wi, wo))
    least = max(np.cos(np.radians(max_angle)), 1e-6)
    counts = (wi[:, 2] > least) & (wo[:, 2] > least)
    shares = np.where(counts, LIGHTS[name](world) * wi[:, 2] / density, 0.0)
    # What does not count is looked up along the normal, where every BRDF is defined
    wi, wo = (np.where(counts[:, None], w, (0.0, 0.0, 1.0)) for w in (wi, wo))
    return wi, wo, shares


def _find_white(values, weights):
    """The value (1,) above which the `weights` (n,) of pixels are those that may be brighter."""
    order = np.argsort(values)
    sums = np.cumsum(weights[order])
    return values[order][np.searchsorted(sums, (1 - BRIGHTER) * sums[-1])]


def sum_pairs(values, shares, pairs):
    """The pixels (pixels, channels) of which the pairs have these `values` (n, channels)."""
    return (shares[:, None] * values).reshape(-1, pairs, values.shape[1]).sum(axis=1)


def _stratify(rng, pixels, count):
    """Points (pixels, count, 3) of the unit cube: those of a pixel are in different strata of each
    axis."""
    shape = pixels, count, 3
    strata = rng.random(shape).argsort(axis=1)
    return (strata + rng.random(shape)) / count
