"""Defines scenes for frames of shadows: objects on a ground, seen from above, under a light."""

from brdfkit.theses.balint2019 import scenes, view

from brdfkit.distance_fields import box

BALL = 0.01  # first radius of the cones at points on the ground, about half a pixel
LIGHT = 2.0, -1.5, 6.0


def cube():
    """Return the distance field of a cube with edges of length 2."""
    return box(2).at(0, 0, 1)


def simple():
    """Return the distance field of three spheres and a box on a plane."""
    return scenes.simple().field


def complicated():
    """Return the distance field of 25 objects on a plane."""
    return scenes.complicated().field


def make_light_cones(size, radius, half=4.0):
    """Return size² cones, row by row, from points of the ground to a light of this `radius`."""
    return view.make_ground_cones(size, half, LIGHT, radius, BALL)
