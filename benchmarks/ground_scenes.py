"""Scenes for frames of shadows, after those of the thesis: what stands on a ground, under a light.

Its cameras and coordinates are not printed; a frame is the ground itself, seen from above.
"""

import numpy as np
from shadow_fields import Box, HalfSpace, Sphere, Union, vector

from brdfkit.distance_fields.shadows import light_cone

BALL = 0.01  # of the points on the ground, about half a pixel
LIGHT = 2.0, -1.5, 6.0


def cube():
    """S0: a cube of edge 2, whose top is 9 from the light's centre; here the light is at 6."""
    return Union(Box([0, 0, 1], [1, 1, 1]))


def simple():
    """S1: three spheres and a box, on a plane."""
    return Union(
        Sphere([-1.2, 0.3, 0.8], 0.8),
        Sphere([0.7, 1.0, 0.5], 0.5),
        Sphere([0.2, -1.2, 0.4], 0.4),
        Box([1.3, -0.4, 0.6], [0.4, 0.4, 0.6]),
        HalfSpace([0, 0, 1], 0.0),
    )


def complicated():
    """S2: 25 objects on a plane."""
    rng = np.random.default_rng(2)
    places = np.column_stack([rng.uniform(-3, 3, (25, 2)), rng.uniform(0.2, 1, 25)])
    objects = [Sphere(c, c[2] * 0.6) for c in places[:12]]
    objects += [Box(c, rng.uniform(0.1, 0.5, 3)) for c in places[12:]]
    return Union(*objects, HalfSpace([0, 0, 1], 0.0))


def ground(size, radius, half=4.0):
    """The cones (size², in rows) from the ground to a light of this `radius`."""
    x = (np.arange(size) + 0.5) / size * 2 * half - half
    x, y = (v.ravel() for v in np.meshgrid(x, x))
    points = vector(np.stack([x, y, 0 * x + 1.05 * BALL], 1))
    return light_cone(points, vector(np.tile(LIGHT, (len(x), 1))), radius, BALL)
