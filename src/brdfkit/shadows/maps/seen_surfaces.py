"""What a camera sees of a scene, by rays through a coarse picture: what partitions are tuned to."""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from brdfkit.core.projective.body import Empty
from brdfkit.core.projective.homogeneous import project_all
from brdfkit.mitsuba_bridge.surface_points import ray_off_surface

SIDE = 128  # rays across a picture and down it


@dataclass(frozen=True)
class SeenSurfaces:
    """The surfaces seen: `points` (n, 3), their `normals` (n, 3), their `distances` (n,) along the
    rays, and which of the rays, row by row, `hit` them, (SIDE, SIDE)."""

    points: np.ndarray
    normals: np.ndarray
    distances: np.ndarray
    hit: np.ndarray


def seen_surfaces(scene, camera):
    """What a `Camera` sees of a `mi.Scene`; `Empty` where all of its rays miss."""
    import mitsuba as mi

    places = (np.arange(SIDE) + 0.5) / SIDE * 2 - 1
    x, y = (grid.ravel() for grid in np.meshgrid(places, places))
    near, far = (
        project_all(np.linalg.inv(camera.matrix), np.column_stack([x, y, np.full_like(x, z)]))
        for z in (-1, 1)
    )
    ray = mi.Ray3f(mi.Point3f(near.T), dr.normalize(mi.Vector3f((far - near).T)))
    si = scene.ray_intersect(ray)
    hit = np.array(si.is_valid())
    if not hit.any():
        raise Empty("the camera does not see any surface: turn it, or move it.")
    points, normals = (np.array(vectors).T[hit] for vectors in (si.p, si.n))
    return SeenSurfaces(points, normals, np.array(si.t)[hit], hit.reshape(SIDE, SIDE))


def lit(scene, light, seen):
    """Whether a `Light` reaches the points of `SeenSurfaces`: (n,) booleans, by rays."""
    import mitsuba as mi

    to_light = light.directions_from(seen.points)
    p, n, d = mi.Point3f(seen.points.T), mi.Normal3f(seen.normals.T), mi.Vector3f(to_light.T)
    ray = ray_off_surface(p, n, mi.Float(seen.distances), d)
    if not light.is_directional:
        distances = np.linalg.norm(light.point[:3] - seen.points, axis=1)
        ray.maxt = mi.Float(distances * (1 - 1e-4))
    facing = np.einsum("ij,ij->i", seen.normals, to_light) > 0
    return facing & ~np.array(scene.ray_test(ray))
