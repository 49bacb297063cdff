"""Draws points of the ball, given by their normals: everywhere, and more in highlights."""

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.geometry.directions import normalize
from brdfkit.core.quasi_random import draw_halton_points
from brdfkit.images.ball.half_vectors import HalfVectors
from brdfkit.images.ball.lights import LightSampling

# The direction to the camera, as in the scene of `brdfkit.render`
VIEW = normalize((0.0, -8.0, 2.2))
SOURCES = 256  # number of directions drawn by a light, whose highlights get more normals


def draw_normals(
    count: int, light: LightSampling, half_vectors: HalfVectors, rng: np.random.Generator
) -> tuple[AnyArray, AnyArray]:
    """Draw normals of points of the ball, half of them in highlights.

    Returns the normals (count, 3), and their weights (count,), by which a weighted mean over them
    is a mean over the ball's disc. Half of the normals are spread evenly. The others are drawn by
    the material's distribution of half vectors, about the half vectors of camera and light, so that
    even the narrow highlight of a small lamp gets some normals.
    """
    *point, choice, source = draw_halton_points(count, 5, rng).T
    points = np.stack(point, axis=1)
    centres = normalize(VIEW + light.sample(draw_halton_points(SOURCES, 3, rng)))
    about = make_frames(centres[(source * SOURCES).astype(int)])
    normals = (half_vectors.draw_half_vectors(points)[:, None] @ about)[:, 0]
    # Half of the normals, and those that face away from the camera, become evenly spread ones
    spread = (choice < 0.5) | (normals @ VIEW < 1e-3)
    normals = np.where(spread[:, None], _spread_normals(points), normals)
    # Densities per solid angle of the evenly spread normals and of those in highlights
    even = normals @ VIEW / np.pi
    bright = half_vectors.density(np.arccos(np.minimum(normals @ centres.T, 1))).mean(axis=1)
    weights = even / (spread.mean() * even + 0.5 * bright)
    return normals, weights


def _spread_normals(u: AnyArray) -> AnyArray:
    """Return normals (n, 3) spread evenly over the ball's disc, by points `u` of the unit cube."""
    radius, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return find_normals(radius * np.cos(phi), radius * np.sin(phi))


def find_normals(x: AnyArray, y: AnyArray) -> AnyArray:
    """Return the ball's normals (n, 3) at picture coordinates `x`, to the right, and `y`, up (n,).

    The coordinates lie within the unit disc, which is the ball as the camera sees it.
    """
    right = normalize(np.cross((0.0, 0.0, 1.0), VIEW))
    up = np.cross(VIEW, right)
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    return np.stack([x, y, z], axis=1) @ np.stack([right, up, VIEW])


def make_frames(normals: AnyArray) -> AnyArray:
    """Return the matrices (n, 3, 3) that rotate from the world to the frame of each normal (n, 3).

    The z axis of a frame is the normal. Its x axis follows the ball's circles of latitude, which is
    also the direction in which `brdfkit.render` brushes anisotropic materials.
    """
    x = normalize(np.cross((0.0, 0.0, 1.0), normals))
    return np.stack([x, np.cross(normals, x), normals], axis=1)
