"""Finds the surfaces that a camera sees, by a coarse grid of rays, to adapt partitions to them."""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, MitsubaObject
from brdfkit.core.projective.body import Empty
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.homogeneous import project_points
from brdfkit.core.projective.light import Light
from brdfkit.mitsuba_bridge.surface_points import spawn_ray

SIDE = 128  # number of rays along each side of the picture


@dataclass(frozen=True)
class VisibleSurfaces:
    """Surface points that a coarse grid of camera rays hits.

    points, normals : the points and their normals (n, 3), for the n rays that hit a surface.
    distances : distances (n,) of the points along the rays.
    hit : True for each ray of the grid that hits a surface, (SIDE, SIDE).
    """

    points: AnyArray
    normals: AnyArray
    distances: AnyArray
    hit: AnyArray


def find_visible_surfaces(scene: MitsubaObject, camera: Camera) -> VisibleSurfaces:
    """Return the surfaces of a `mi.Scene` that a camera sees; raise `Empty` if all rays miss."""
    import mitsuba as mi

    places = (np.arange(SIDE) + 0.5) / SIDE * 2 - 1
    x, y = (grid.ravel() for grid in np.meshgrid(places, places))
    near, far = (
        project_points(np.linalg.inv(camera.matrix), np.column_stack([x, y, np.full_like(x, z)]))
        for z in (-1, 1)
    )
    ray = mi.Ray3f(mi.Point3f(near.T), dr.normalize(mi.Vector3f((far - near).T)))
    si = scene.ray_intersect(ray)
    hit = np.array(si.is_valid())
    if not hit.any():
        raise Empty("the camera does not see any surface: turn or move it.")
    points, normals = (np.array(vectors).T[hit] for vectors in (si.p, si.n))
    return VisibleSurfaces(points, normals, np.array(si.t)[hit], hit.reshape(SIDE, SIDE))


def is_lit(scene: MitsubaObject, light: Light, surfaces: VisibleSurfaces) -> BoolArray:
    """Return whether a light reaches each visible surface point (n,), from shadow rays."""
    import mitsuba as mi

    to_light = light.directions_to_light(surfaces.points)
    p, n = mi.Point3f(surfaces.points.T), mi.Normal3f(surfaces.normals.T)
    d = mi.Vector3f(to_light.T)
    ray = spawn_ray(p, n, mi.Float(surfaces.distances), d)
    if not light.is_directional:
        distances = np.linalg.norm(light.point[:3] - surfaces.points, axis=1)
        ray.maxt = mi.Float(distances * (1 - 1e-4))
    facing = np.einsum("ij,ij->i", surfaces.normals, to_light) > 0
    return facing & ~np.array(scene.ray_test(ray))
