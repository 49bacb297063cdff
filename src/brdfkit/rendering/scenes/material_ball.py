"""A ball with a band and an opening on an inner ball, on a ring, on a chequered floor."""

import numpy as np

from brdfkit.rendering.scenes._meshes import mesh_of_grid, revolve
from brdfkit.rendering.scenes._studio import studio

INNER = 0.84  # radius of the inner ball; the outer one's is 1
OPENING, BAND = 0.62, (1.32, 1.5)  # angles from the axis of the ball [radians]
EDGE = 0.03  # half-width of a rounded edge [radians]
AXIS = (-0.42, -0.66, 0.62)  # of the ball: to the camera, up and to the left
RING, WIRE = 0.62, 0.1  # radii of the ring's circle and of its section


def material_ball(bsdf, size=(512, 512)):
    """The scene's dictionary; see `brdfkit.rendering.scenes`.

    The ball is brushed around its axis, the ring around its own.

    >>> sorted(set(material_ball({"type": "diffuse"})) & {"ball", "ring"})    # doctest: +SKIP
    ['ball', 'ring']
    """
    import mitsuba as mi

    height = WIRE + np.sqrt((1 + WIRE) ** 2 - RING**2)  # of the ball's middle, on the ring
    points, normals = (_turn(x) for x in revolve(*_ball_profile()))
    floor = {
        "type": "checkerboard",
        "color0": 0.24,
        "color1": 0.4,
        "to_uv": mi.ScalarTransform4f().scale(140),
    }
    return studio(size) | {
        "ball": mesh_of_grid(points + np.array([0, 0, height]), normals, bsdf),
        "ring": mesh_of_grid(*revolve(*_ring_profile()), bsdf),
        "ground": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale(100),
            "bsdf": {"type": "diffuse", "reflectance": floor},
        },
    }


def _ball_profile():
    """(r, z) of the ball from its lower pole up, with its band and its opening."""

    def step(theta, edge):
        return (1 + np.tanh((theta - edge) / EDGE * 2)) / 2

    edges = np.add.outer((OPENING, *BAND), 3 * EDGE * np.linspace(-1, 1, 49))
    theta = np.unique([*np.linspace(0, np.pi, 120), *edges.ravel()])[::-1]
    sunk = 1 - step(theta, OPENING) + step(theta, BAND[0]) - step(theta, BAND[1])
    radius = 1 - (1 - INNER) * sunk
    r = radius * np.sin(theta)
    r[[0, -1]] = 0
    return r, radius * np.cos(theta)


def _ring_profile():
    """(r, z) of the ring."""
    t = np.linspace(0, 2 * np.pi, 73)
    t[-1] = 0
    return RING + WIRE * np.cos(t), WIRE + WIRE * np.sin(t)


def _turn(vectors):
    """Vectors with z turned into the ball's axis."""
    up = np.array(AXIS) / np.linalg.norm(AXIS)
    side = np.cross((0, 0, 1), up)
    side /= np.linalg.norm(side)
    return vectors @ np.array([side, np.cross(up, side), up])
