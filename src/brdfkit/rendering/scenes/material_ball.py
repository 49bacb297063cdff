"""A ball with a band and an opening that shows an inner ball, on a ring, on a chequered floor."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.rendering.scenes._meshes import make_grid_mesh, revolve_profile
from brdfkit.rendering.scenes._studio import make_studio

INNER = 0.84  # radius of the inner ball [m]; the outer ball has radius 1
# Angles from the ball's axis to the edge of the opening, and to both edges of the band [radians]
OPENING, BAND = 0.62, (1.32, 1.5)
EDGE = 0.03  # half the width of a rounded edge [radians]
AXIS = (-0.42, -0.66, 0.62)  # the ball's axis: towards the camera, up and to the left
RING, WIRE = 0.62, 0.1  # radii of the ring and of its cross-section [m]


def material_ball(
    bsdf: dict[str, Any] | MitsubaObject, size: tuple[int, int] = (512, 512)
) -> dict[str, Any]:
    """Return the dictionary of a scene that shows the material `bsdf` on a ball with an opening.

    An anisotropic material is brushed around the axes of the ball and of the ring.

    >>> sorted(set(material_ball({"type": "diffuse"})) & {"ball", "ring"})    # doctest: +SKIP
    ['ball', 'ring']
    """
    import mitsuba as mi

    height = WIRE + np.sqrt((1 + WIRE) ** 2 - RING**2)  # the ball's centre, over the ground
    points, normals = (_rotate_to_ball_axis(x) for x in revolve_profile(*_make_ball_profile()))
    floor = {
        "type": "checkerboard",
        "color0": 0.24,
        "color1": 0.4,
        "to_uv": mi.ScalarTransform4f().scale(140),
    }
    return make_studio(size) | {
        "ball": make_grid_mesh(points + np.array([0, 0, height]), normals, bsdf),
        "ring": make_grid_mesh(*revolve_profile(*_make_ring_profile()), bsdf),
        "ground": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale(100),
            "bsdf": {"type": "diffuse", "reflectance": floor},
        },
    }


def _make_ball_profile() -> tuple[FloatArray, FloatArray]:
    """Return radii and heights of the ball's profile, from its lower pole to its upper pole."""

    def smooth_step(theta: FloatArray, edge: float) -> FloatArray:
        """Return a step from 0 to 1 at the angle `edge`, rounded over the width of an edge."""
        return (1 + np.tanh((theta - edge) / EDGE * 2)) / 2

    edges = np.add.outer((OPENING, *BAND), 3 * EDGE * np.linspace(-1, 1, 49))
    theta = np.unique([*np.linspace(0, np.pi, 120), *edges.ravel()])[::-1]
    sunk = 1 - smooth_step(theta, OPENING)
    sunk += smooth_step(theta, BAND[0]) - smooth_step(theta, BAND[1])
    radius = 1 - (1 - INNER) * sunk
    r = radius * np.sin(theta)
    r[[0, -1]] = 0
    return r, radius * np.cos(theta)


def _make_ring_profile() -> tuple[FloatArray, FloatArray]:
    """Return radii and heights of the ring's closed profile."""
    t = np.linspace(0, 2 * np.pi, 73)
    t[-1] = 0
    return RING + WIRE * np.cos(t), WIRE + WIRE * np.sin(t)


def _rotate_to_ball_axis(vectors: FloatArray) -> FloatArray:
    """Rotate vectors (..., 3) so that the z axis becomes the axis of the ball."""
    up = np.array(AXIS) / np.linalg.norm(AXIS)
    side = np.cross((0, 0, 1), up)
    side /= np.linalg.norm(side)
    return vectors @ np.array([side, np.cross(up, side), up])
