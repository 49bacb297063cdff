"""Shadow volumes out of a shadow map: silhouettes where its depths jump, not edges of meshes.

The map's texels become a surface that is torn where depths jump; its border is the silhouette, and
walls go from there away from the light [McCool 2000]. So all shapes cast, whether they have
triangles or not, and the volumes depend on the map's resolution, not on the scene.
"""

import numpy as np

from brdfkit.shadows.maps.depth_pass import depth_pass
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projections import focused
from brdfkit.shadows.volumes.light_volumes import LightVolumes
from brdfkit.shadows.volumes.mesh import Mesh
from brdfkit.shadows.volumes.seen_faces import pinhole


def hybrid_shadow(scene, sensor, emitter, resolution, jump):
    """The `LightVolumes` of a scene's depth map in one light.

    They are counted by depth-pass: caps would lie on all that the light sees.

    resolution : texels along a side of the map.
    jump : see `surface_of`.
    """
    placement = Placement.of_scene(scene, sensor, emitter)
    pixels = max(sensor.film().size())
    return volumes_of_map(scene, placement, pinhole(sensor), resolution, jump, pixels)


def volumes_of_map(scene, placement, camera, resolution, jump, pixels):
    """The same from a `Placement`, counted in the picture of a `Camera`.

    pixels : along the longer side of the picture; see `LightVolumes`.
    """
    projection = focused.projection(placement)
    depths = np.array(depth_pass(scene, projection, resolution))
    mesh = surface_of(depths, projection, jump)
    return LightVolumes([mesh], placement.light, camera, "depth_pass", pixels=pixels)


def surface_of(depths, projection, jump):
    """What a map of `depths` (n, n) shows, as a `Mesh` between the middles of its texels.

    projection : the `Projection` of the map.
    jump : the change of distance to the light between texels, over their width, from which on the
        surface is torn.
    """
    n = len(depths)
    middles = (np.arange(n) + 0.5) * 2 / n - 1
    x, y = np.meshgrid(middles, middles)
    hit = np.isfinite(depths)
    depths = np.where(hit, depths, 0)
    points = np.stack(projection.from_map(x, y, depths), axis=-1)
    beside = np.stack(projection.from_map(x + 2 / n, y, depths), axis=-1)
    width = np.linalg.norm(beside - points, axis=-1)
    way = projection.light.path_length(*np.moveaxis(points, -1, 0))
    whole = corners(hit).all(axis=0)
    whole &= np.ptp(corners(way), axis=0) <= jump * corners(width).max(axis=0)
    a, b, c, d = corners(np.arange(n * n).reshape(n, n))[:, whole]
    triangles = np.concatenate([np.column_stack([a, b, d]), np.column_stack([a, d, c])])
    return Mesh("the depth map", points.reshape(-1, 3), triangles)


def corners(values):
    """The values (4, n - 1, n - 1) at the corners of the cells between texels (n, n)."""
    return np.stack([values[:-1, :-1], values[:-1, 1:], values[1:, :-1], values[1:, 1:]])
