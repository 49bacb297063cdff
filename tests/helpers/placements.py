"""Cameras, lights and boxes for the projections of shadow maps, without a renderer."""

import numpy as np

from brdfkit.core.projective.body import make_box
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.homogeneous import make_axes, make_rigid_matrix
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.placement import Placement

LOW, HIGH = np.array([-20.0, -20, 0]), np.array([20.0, 20, 3])
SUN = np.array([-1, 0, 1]) / np.sqrt(2)
LIGHTS = {
    "directional": Light(np.append(SUN, 0)),
    "point": Light(np.append(35 * SUN, 1)),
    "spot": Light(np.append(35 * SUN, 1), -SUN, np.radians(30)),
}
# eye and target: at right angles to the sun, into it, between, and along its rays
VIEWS = {
    "perpendicular": ([0, -16, 1.7], [0, 0, 1]),
    "dueling frusta": ([14, 2, 1], [0, 2, 4]),
    "intermediate": ([10, -12, 2.5], [0, 0, 1]),
    "miner's lamp": ([-14, 1, 14], [0, 1, 0]),
}


def camera(eye, target, near=0.1, far=1e3, slope=0.4):
    """A `Camera` whose y is about the world's z."""
    eye, back = np.array(eye, float), np.subtract(eye, target)
    axes = make_axes(back / np.linalg.norm(back), [0, 0, 1])
    return Camera(make_rigid_matrix(axes, eye), slope, slope, near, far)


def placement(camera, light, low=LOW, high=HIGH, nearest=0.0):
    """A `Placement`, as `Placement.of_scene` makes it."""
    low, high = np.array(low, float), np.array(high, float)
    return Placement(
        camera.fit_near_and_far(make_box(low, high).corners), light, low, high, nearest
    )
