"""Scenes for frames of shadows: what stands on a ground, seen from above, under a light."""

from brdfkit.theses.balint2019 import scenes, view

from brdfkit.distance_fields import box

BALL = 0.01  # of the points on the ground, about half a pixel
LIGHT = 2.0, -1.5, 6.0


def cube():
    """A cube of edge 2."""
    return box(2).at(0, 0, 1)


def simple():
    """Three spheres and a box, on a plane."""
    return scenes.simple().field


def complicated():
    """25 objects on a plane."""
    return scenes.complicated().field


def ground(size, radius, half=4.0):
    """The cones (size², in rows) from the ground to a light of this `radius`."""
    return view.ground(size, half, LIGHT, radius, BALL)
