"""Draws points of the ball for pictures, by their normals: everywhere, and more in highlights."""

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.geometry.directions import normalize
from brdfkit.images.ball.half_vectors import HalfVectors
from brdfkit.images.ball.lights import LightSampling

# The direction to the eye, as in the scene of `render`
VIEW = normalize((0.0, -8.0, 2.2))
SOURCES = 256  # directions of a light, by which highlights are found


def draw_normals(
    count: int, light: LightSampling, half_vectors: HalfVectors, rng: np.random.Generator
) -> tuple[AnyArray, AnyArray]:
    """Draw normals (count, 3) of points of the ball, and weights (count,) that even them out.

    Half of them are drawn evenly over the disc, half in highlights: about the half vectors of the
    eye and the light, by the distribution of the material. So even a narrow highlight of a small
    lamp, which few pixels of a picture show, gets some normals.
    """
    from scipy.stats import qmc

    *point, choice, source = qmc.Halton(5, rng=rng).random(count).T
    points = np.stack(point, axis=1)
    centres = normalize(VIEW + light.sample(qmc.Halton(3, rng=rng).random(SOURCES)))
    about = make_frames(centres[(source * SOURCES).astype(int)])
    normals = (half_vectors.draw(points)[:, None] @ about)[:, 0]
    # Normals that face away are replaced by normals that are even over the disc
    spread = (choice < 0.5) | (normals @ VIEW < 1e-3)
    normals = np.where(spread[:, None], _spread_normals(points), normals)
    # Densities per solid angle of both kinds, mixed by their numbers of normals
    even = normals @ VIEW / np.pi
    bright = half_vectors.density(np.arccos(np.minimum(normals @ centres.T, 1))).mean(axis=1)
    weights = even / (spread.mean() * even + 0.5 * bright)
    return normals, weights


def _spread_normals(u: AnyArray) -> AnyArray:
    """Return normals (n, 3), even over the disc, for points `u` (n, 3) of the unit cube."""
    radius, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return find_normals(radius * np.cos(phi), radius * np.sin(phi))


def find_normals(x: AnyArray, y: AnyArray) -> AnyArray:
    """Return the ball's normals (n, 3) at places `x` to the right and `y` upwards (n,).

    The places lie within the disc of radius 1 about the middle of the ball.
    """
    right = normalize(np.cross((0.0, 0.0, 1.0), VIEW))
    up = np.cross(VIEW, right)
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    return np.stack([x, y, z], axis=1) @ np.stack([right, up, VIEW])


def make_frames(normals: AnyArray) -> AnyArray:
    """Return matrices (n, 3, 3) from the world to the frame of each normal (n, 3).

    x runs along the ball's parallels, along which `render` brushes an anisotropic material.
    """
    x = normalize(np.cross((0.0, 0.0, 1.0), normals))
    return np.stack([x, np.cross(normals, x), normals], axis=1)
