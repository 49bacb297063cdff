"""Pixels of pictures of a ball under direct light: I_p = Σ_s a_s f(wi_s, wo_s).

The directions wi are drawn once, by the light and by the material, and weighted by the balance
heuristic [Veach & Guibas 1995]. So a picture is linear in the BRDF f, and so are its derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.images.ball.half_vectors import Brdf, HalfVectors
from brdfkit.images.ball.lights import LIGHTS, get_sampling
from brdfkit.images.ball.normals import VIEW, draw_normals, make_frames

# Pixels of all pictures, and directions of each that the light draws, as many as the material draws
PIXELS, DIRECTIONS = 960, 64
# The share of a picture that may be brighter than 1
BRIGHT_SHARE = 0.01


@dataclass(frozen=True, eq=False)
class Pixels:
    """Pixels with equal numbers of direction pairs, one pixel after the other.

    `pairs` is the number of pairs of each pixel. `wi` and `wo` (pixels · pairs, 3) are the
    directions, `shares` (pixels · pairs,) the factors a. `values` (pixels, channels) are those of
    the measured material. `weights` (pixels,) say how much of all pictures a pixel stands for, 1 on
    average. Any first pixels are spread over all pictures and each ball.
    """

    wi: np.ndarray
    wo: np.ndarray
    shares: np.ndarray
    values: np.ndarray
    weights: np.ndarray
    pairs: int

    def look(self, brdf: Brdf) -> AnyArray:
        """Return the pixels (pixels, channels) of another BRDF."""
        return sum_pairs(brdf(self.wi, self.wo), self.shares, self.pairs)

    def take_first(self, count: int) -> Pixels:
        """Return the first `count` pixels."""
        return self.at(slice(count))

    def at(self, rows: Any) -> Pixels:
        """Return the pixels of some `rows`, a slice, a mask or indices."""
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
    """Draw pixels of a ball of a BRDF, in one picture for each name of `lights`.

    Directions at or beyond `max_angle` [degrees] to the normal do not count. `pixels` is their
    number in all pictures; `directions` is the number of directions of each pixel that the light
    draws, and as many are drawn by the BRDF.
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


def _draw_picture(
    name: str,
    brdf: Brdf,
    half_vectors: HalfVectors,
    max_angle: float,
    rng: np.random.Generator,
    pixels: int,
    directions: int,
) -> tuple[AnyArray, ...]:
    """Draw the pixels of one picture.

    Returns wi and wo (pixels, pairs, 3), shares (pixels, pairs), values (pixels, channels) and
    weights (pixels,).
    """
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


def draw_directions(
    normals: AnyArray,
    name: str,
    half_vectors: HalfVectors,
    max_angle: float,
    for_light: AnyArray,
    for_brdf: AnyArray,
) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Draw direction pairs at points with `normals` (n, 3) under the light called `name`.

    `for_light` and `for_brdf` are points (n, directions, 3) of the unit cube, from which the light
    and the BRDF draw. Returns wi and wo (n · pairs, 3), and the factors (n · pairs,) of the BRDF in
    the radiance that reaches the eye.
    """
    light, shape = get_sampling(name), for_light.shape
    frames, directions = make_frames(normals), shape[1]
    wo = np.repeat((frames @ VIEW)[:, None], 2 * directions, axis=1)
    # Directions in the frame of each normal; the light draws its directions in the world
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
    # Pairs that do not count are moved to the normal, where every BRDF is defined
    wi, wo = (np.where(counts[:, None], w, (0.0, 0.0, 1.0)) for w in (wi, wo))
    return wi, wo, shares


def _find_white(values: AnyArray, weights: AnyArray) -> Any:
    """Return the value that pixels of the share `BRIGHT_SHARE` exceed, by their `weights` (n,)."""
    order = np.argsort(values)
    sums = np.cumsum(weights[order])
    return values[order][np.searchsorted(sums, (1 - BRIGHT_SHARE) * sums[-1])]


def sum_pairs(values: AnyArray, shares: AnyArray, pairs: int) -> AnyArray:
    """Sum values (n, channels) of pairs, times shares (n,), to pixels (pixels, channels)."""
    return (shares[:, None] * values).reshape(-1, pairs, values.shape[1]).sum(axis=1)


def _stratify(rng: np.random.Generator, pixels: int, count: int) -> AnyArray:
    """Draw points (pixels, count, 3) of the unit cube, stratified on each axis within a pixel."""
    shape = pixels, count, 3
    strata = rng.random(shape).argsort(axis=1)
    return (strata + rng.random(shape)) / count
