"""Finds the points of a scene that a camera sees, and cones from them to a light.

Around each point is an empty ball, which touches the nearest object.
"""

from functools import cached_property

import drjit as dr
import numpy as np
from drjit.llvm import Array3f, Float, UInt

from brdfkit.distance_fields import cone_trace, normal, pixel_tangent
from brdfkit.distance_fields.shadows import make_light_cone


def make_ground_cones(size, half, light, radius, ball):
    """Return the light cones (size², in rows) of a square about the origin of the plane z = 0.

    half : half of the square's edge.
    light : the centre of a light of this `radius`.
    ball : the radius of the empty balls about the points, which touch the plane.
    """
    i = dr.arange(UInt, size * size)
    x = (Float(i % size) + 0.5) / size * 2 * half - half
    y = (Float(i // size) + 0.5) / size * 2 * half - half
    cones = make_light_cone(Array3f(x, y, 1.05 * ball), Array3f(light), radius, ball)
    dr.eval(cones)
    return cones


FAR, PRECISION = 100.0, 1e-4
STEP = 1e-3  # of the finite differences that give normals
SKY, AMBIENT = 0.8, 0.15  # the grey of pictures without an object, and of unlit surfaces


class View:
    """The points of a `Scene` that a square picture of `size` × `size` pixels shows.

    rows : the rows of a larger picture, of which these pixels are a sample, as wide as they are
        there; by default `size`.
    """

    def __init__(self, scene, size, rows=None):
        self.scene, self.size = scene, size
        hit, points = find_points(scene, size, rows)
        self.seen = np.array(hit.found)
        lanes = dr.compress(hit.found)
        self.points = dr.gather(Array3f, points, lanes)
        self.ball = dr.gather(Float, hit.distance, lanes)
        dr.eval(self.points, self.ball)

    def make_cones(self, radius):
        """Return the cones from all points to a light of this radius."""
        cones = make_light_cone(self.points, Array3f(self.scene.light), radius, self.ball)
        dr.eval(cones)
        return cones

    @cached_property
    def facing(self):
        """The cosine between normal and light (n,), 0 where a point looks away."""
        n = normal(self.scene.field.distance, self.points, dr.maximum(self.ball, STEP))
        l = dr.normalize(Array3f(self.scene.light) - self.points)
        return np.array(dr.maximum(dr.dot(n, l), 0))

    def shade(self, visible):
        """Return a picture (size, size) of grey surfaces, by shares (n,) of the light."""
        return self.make_image(AMBIENT + (1 - AMBIENT) * self.facing * visible, SKY)

    def make_image(self, values, other=np.nan):
        """Return values of the points as an image (size, size), `other` where there is no point."""
        found = np.full(self.seen.shape, other, float)
        found[self.seen] = values
        return found.reshape(self.size, self.size)


def find_points(scene, size, rows=None):
    """Return where the eye rays of a picture end, as `Hit` of cone tracing and as points."""
    field, eye, d = scene.field, Array3f(scene.eye), compute_ray_directions(scene, size)
    tangent = pixel_tangent(scene.fov, rows or size)
    how = {"lipschitz": field.lipschitz, "tangent": tangent, "precision": PRECISION}
    hit = cone_trace(field.distance, eye, d, FAR, **how)
    return hit, eye + d * hit.t


def trace_eye_rays(scene, size, rows=None):
    """Return what all pixels of a picture show: points, normals, empty balls, whether there is any.

    Nothing is run, so that it can be part of a larger kernel.
    """
    hit, points = find_points(scene, size, rows)
    normals = normal(scene.field.distance, points, dr.maximum(hit.distance, STEP))
    return points, normals, hit.distance, hit.found


def shade_points(light, points, normals, found, visible):
    """Return grey pixels by shares `visible` of the light."""
    facing = dr.maximum(dr.dot(normals, dr.normalize(light - points)), 0)
    return dr.select(found, AMBIENT + (1 - AMBIENT) * facing * visible, SKY)


def compute_ray_directions(scene, size):
    """Return the directions of the rays through the middles of pixels, in rows from above."""
    i = dr.arange(UInt, size * size)
    x = (Float(i % size) + 0.5) / size * 2 - 1
    y = 1 - (Float(i // size) + 0.5) / size * 2
    ahead = dr.normalize(Array3f(scene.target) - Array3f(scene.eye))
    right = dr.normalize(dr.cross(ahead, Array3f(0, 0, 1)))
    up = dr.cross(right, ahead)
    return dr.normalize(ahead + (right * x + up * y) * np.tan(np.radians(scene.fov) / 2))
