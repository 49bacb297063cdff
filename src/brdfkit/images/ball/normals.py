"""Points of the ball that pictures show, by their normals: everywhere, and more in highlights."""

import numpy as np

from brdfkit.core.geometry.directions import normalize

# The direction to the eye, as in the scene that `render` shows
VIEW = normalize((0.0, -8.0, 2.2))
# So many of a light's directions stand for it, when highlights are sought
SOURCES = 256


def draw_normals(count, light, half_vectors, rng):
    """Normals (count, 3) of points of the ball's disc, and weights (count,), by which they show it
    evenly.

    Half of them are drawn evenly over the disc, half in highlights: about the half vectors of the
    eye and of the `light`, a `LightSampling`, by those of the material, `HalfVectors`. So a
    narrow highlight of a small lamp, which few pixels of a picture show, has some.
    """
    from scipy.stats import qmc

    *point, way, source = qmc.Halton(5, rng=rng).random(count).T
    points = np.stack(point, axis=1)
    centres = normalize(VIEW + light.sample(qmc.Halton(3, rng=rng).random(SOURCES)))
    about = make_frames(centres[(source * SOURCES).astype(int)])
    normals = (half_vectors.draw(points)[:, None] @ about)[:, 0]
    # Those that face away go to the disc, too
    spread = (way < 0.5) | (normals @ VIEW < 1e-3)
    normals = np.where(spread[:, None], _spread_normals(points), normals)
    # Densities per solid angle of both ways, mixed by how many normals each draws
    even = normals @ VIEW / np.pi
    bright = half_vectors.density(np.arccos(np.minimum(normals @ centres.T, 1))).mean(axis=1)
    weights = even / (spread.mean() * even + 0.5 * bright)
    return normals, weights


def _spread_normals(u):
    """Normals (n, 3), even over the disc, for points `u` (n, 3) of the unit cube."""
    radius, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return find_normals(radius * np.cos(phi), radius * np.sin(phi))


def find_normals(x, y):
    """Normals (n, 3) of the points of the ball that are seen at `x` to the right and `y` upwards
    (n,) of its middle, within the disc of radius 1."""
    right = normalize(np.cross((0.0, 0.0, 1.0), VIEW))
    up = np.cross(VIEW, right)
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    return np.stack([x, y, z], axis=1) @ np.stack([right, up, VIEW])


def make_frames(normals):
    """Matrices (n, 3, 3) from the world to the frame of each normal (n, 3): x runs along the ball's
    parallels, along which `render` brushes an anisotropic material."""
    x = normalize(np.cross((0.0, 0.0, 1.0), normals))
    return np.stack([x, np.cross(normals, x), normals], axis=1)
