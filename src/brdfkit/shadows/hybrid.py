"""Shadow volumes made from a shadow map: silhouettes where its depths jump, not edges of meshes.

The map's texels become a surface that is torn where depths jump. Its border is the silhouette, from
which walls lead away from the light [McCool 2000]. So all shapes cast, with or without triangles,
and the volumes depend on the map's resolution, not on the scene.
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, MitsubaObject
from brdfkit.core.projective.camera import Camera
from brdfkit.shadows.maps.depth_pass import render_depths
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import focused
from brdfkit.shadows.volumes.light_volumes import LightVolumes
from brdfkit.shadows.volumes.mesh import Mesh
from brdfkit.shadows.volumes.projected_faces import to_pinhole


def hybrid_shadow(
    scene: MitsubaObject,
    sensor: MitsubaObject,
    emitter: MitsubaObject,
    resolution: int,
    jump: float,
) -> LightVolumes:
    """Make the shadow volumes of a scene's depth map in one light.

    They are counted by depth-pass, as caps would lie on all surfaces that the light sees.

    resolution : texels along a side of the map.
    jump : see `map_to_mesh`.
    """
    placement = Placement.from_scene(scene, sensor, emitter)
    pixels = max(sensor.film().size())
    return volumes_of_map(scene, placement, to_pinhole(sensor), resolution, jump, pixels)


def volumes_of_map(
    scene: MitsubaObject,
    placement: Placement,
    camera: Camera,
    resolution: int,
    jump: float,
    pixels: int,
) -> LightVolumes:
    """Make the shadow volumes of a scene's depth map, counted in the picture of a camera.

    pixels : along the longer side of the picture.
    resolution, jump : as in `hybrid_shadow`.
    """
    projection = focused.make_projection(placement)
    depths = np.array(render_depths(scene, projection, resolution))
    mesh = map_to_mesh(depths, projection, jump)
    return LightVolumes([mesh], placement.light, camera, "depth_pass", pixels=pixels)


def map_to_mesh(depths: FloatArray, projection: Projection, jump: float) -> Mesh:
    """Return the surface in a map of `depths` (n, n), as a mesh between the middles of its texels.

    projection : the map's projection.
    jump : the change of distance to the light between texels, over their width, beyond which the
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
    way: Any = projection.light.path_length(*np.moveaxis(points, -1, 0))
    whole = cell_corners(hit).all(axis=0)
    whole &= np.ptp(cell_corners(way), axis=0) <= jump * cell_corners(width).max(axis=0)
    a, b, c, d = cell_corners(np.arange(n * n).reshape(n, n))[:, whole]
    triangles = np.concatenate([np.column_stack([a, b, d]), np.column_stack([a, d, c])])
    return Mesh("the depth map", points.reshape(-1, 3), triangles)


def cell_corners(values: AnyArray) -> AnyArray:
    """Return the values (4, n - 1, n - 1) at the corners of the cells between texels (n, n)."""
    return np.stack([values[:-1, :-1], values[:-1, 1:], values[1:, :-1], values[1:, 1:]])
