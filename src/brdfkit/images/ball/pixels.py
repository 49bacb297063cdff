"""Pixels of pictures of a ball under direct light, as sums of a BRDF f: Σ_s a_s f(wi_s, wo_s).

A pixel has the direction pairs wi_s, wo_s and the factors a_s. The light and a measured material
draw the directions wi_s once; the balance heuristic [Veach & Guibas 1995] combines them in the
factors. So the pixels of any other BRDF f, and their derivatives, are linear in f, and fits can
compare them with the measured material's pixels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.images.ball.half_vectors import Brdf, HalfVectors
from brdfkit.images.ball.lights import LIGHTS, get_light_sampling
from brdfkit.images.ball.normals import VIEW, draw_normals, make_frames

# Number of pixels in all pictures together, and number of directions per pixel that the light
# draws; the material draws as many
PIXELS, DIRECTIONS = 960, 64
BRIGHT_SHARE = 0.01  # share of a picture's pixels that may be brighter than 1


@dataclass(frozen=True, eq=False)
class Pixels:
    """Pixels of a ball, given by the direction pairs at which they sum up a BRDF.

    `wi`, `wo`: directions (pixels · pairs, 3), one pixel after the other.
    `shares`: factors (pixels · pairs,) of the BRDF in its pixel.
    `values`: values (pixels, channels) of the measured material.
    `weights`: weights (pixels,) with which the pixels represent all pictures evenly, 1 on average.
    `pairs`: number of direction pairs per pixel.

    The first pixels, however many, are spread over all pictures and over the whole ball.
    """

    wi: np.ndarray
    wo: np.ndarray
    shares: np.ndarray
    values: np.ndarray
    weights: np.ndarray
    pairs: int

    def evaluate(self, brdf: Brdf) -> AnyArray:
        """Return the values (pixels, channels) of the pixels of a ball with another BRDF."""
        return sum_pairs(brdf(self.wi, self.wo), self.shares, self.pairs)

    def take_first_pixels(self, count: int) -> Pixels:
        """Return the first `count` pixels."""
        return self.at(slice(count))

    def at(self, rows: Any) -> Pixels:
        """Return only the pixels of the given `rows`, a slice, a mask or indices."""
        arrays = (self.wi, self.wo, self.shares)
        by_pixel = (a.reshape(-1, self.pairs, *a.shape[1:])[rows] for a in arrays)
        wi, wo, shares = (a.reshape(-1, *a.shape[2:]) for a in by_pixel)
        return Pixels(wi, wo, shares, self.values[rows], self.weights[rows], self.pairs)


def draw_pixels(
    lights: Sequence[str],
    brdf: Brdf,
    max_angle: float = 90.0,
    seed: int = 0,
    pixels: int = PIXELS,
    directions: int = DIRECTIONS,
) -> Pixels:
    """Draw random pixels of a ball with a measured BRDF, from one picture for each light's name.

    Directions at or beyond `max_angle` [degrees] to the normal contribute nothing. `pixels` is the
    number of pixels in all pictures together; the light draws `directions` directions per pixel,
    and the BRDF as many.
    """
    rng, half_vectors = np.random.default_rng(seed), HalfVectors(brdf)
    count = -(-pixels // len(lights))
    pictures = [
        _draw_picture(name, brdf, half_vectors, max_angle, rng, count, directions)
        for name in lights
    ]
    # The order is: the first pixel of every picture, the second of every picture, and so on
    arrays = (np.stack(parts, axis=1) for parts in zip(*pictures, strict=True))
    wi, wo, shares, values, weights = (a.reshape(-1, *a.shape[2:]) for a in arrays)
    pairs = wi.reshape(-1, 3), wo.reshape(-1, 3), shares.ravel()
    return Pixels(*pairs, values, weights, 2 * directions)


def _draw_picture(
    name: str,
    brdf: Brdf,
    half_vectors: HalfVectors,
    max_angle: float,
    rng: np.random.Generator,
    pixels: int,
    directions: int,
) -> tuple[AnyArray, ...]:
    """Draw the pixels of the picture under one light, with the exposure of the picture.

    Returns the arrays of `Pixels`: wi and wo (pixels, pairs, 3), shares (pixels, pairs), values
    (pixels, channels) and weights (pixels,).
    """
    light, pairs = get_light_sampling(name), 2 * directions
    normals, weights = draw_normals(pixels, light, half_vectors, rng)
    points = [_draw_stratified_points(rng, pixels, directions) for _ in range(2)]
    wi, wo, shares = draw_directions(normals, name, half_vectors, max_angle, *points)
    values = sum_pairs(brdf(wi, wo), shares, pairs)
    exposure = 1 / (_find_bright_value(values.max(axis=1), weights) or 1.0)
    shape = pixels, pairs
    return (
        wi.reshape(*shape, 3),
        wo.reshape(*shape, 3),
        exposure * shares.reshape(shape),
        exposure * values,
        weights,
    )


def draw_directions(
    normals: AnyArray,
    name: str,
    half_vectors: HalfVectors,
    max_angle: float,
    for_light: AnyArray,
    for_brdf: AnyArray,
) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Draw direction pairs at points with `normals` (n, 3) under the light called `name`.

    `for_light` and `for_brdf` are random points (n, directions, 3) of the unit cube, by which the
    light and the BRDF draw. Returns wi and wo (n · pairs, 3) in the frames of the normals, and the
    factors (n · pairs,) of the BRDF in the radiance that reaches the camera.
    """
    light, shape = get_light_sampling(name), for_light.shape
    frames, directions = make_frames(normals), shape[1]
    wo = np.repeat((frames @ VIEW)[:, None], 2 * directions, axis=1)
    # The light draws its directions in the world, so they are rotated to the frame of each normal
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
    # Pairs without contribution are replaced by the normal, where every BRDF is defined
    wi, wo = (np.where(counts[:, None], w, (0.0, 0.0, 1.0)) for w in (wi, wo))
    return wi, wo, shares


def _find_bright_value(values: AnyArray, weights: AnyArray) -> Any:
    """Return the value that the share `BRIGHT_SHARE` of the pixels, by `weights` (n,), exceeds."""
    order = np.argsort(values)
    sums = np.cumsum(weights[order])
    return values[order][np.searchsorted(sums, (1 - BRIGHT_SHARE) * sums[-1])]


def sum_pairs(values: AnyArray, shares: AnyArray, pairs: int) -> AnyArray:
    """Sum the BRDF's values (n, channels) times `shares` (n,) over the `pairs` of each pixel.

    Returns the values (pixels, channels), where n is pixels · pairs.
    """
    return (shares[:, None] * values).reshape(-1, pairs, values.shape[1]).sum(axis=1)


def _draw_stratified_points(rng: np.random.Generator, pixels: int, count: int) -> AnyArray:
    """Draw `count` points of the unit cube for each pixel, stratified along each axis.

    Returns an array (pixels, count, 3).
    """
    shape = pixels, count, 3
    strata = rng.random(shape).argsort(axis=1)
    return (strata + rng.random(shape)) / count
