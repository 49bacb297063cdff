"""Shadow volumes made from a depth map in place of meshes [McCool 2000].

A depth map is a picture of the distances at which the light sees surfaces. Its texels are joined to
a surface, except where the depth jumps from a texel to the next. The border of this surface is the
silhouette from which the walls of the volumes lead away from the light. So shapes without triangles
cast shadows, too, and the cost depends on the map's resolution, not on the scene.
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
from brdfkit.shadows.volumes.projected_faces import make_pinhole_camera


def make_hybrid_shadow(
    scene: MitsubaObject,
    sensor: MitsubaObject,
    emitter: MitsubaObject,
    resolution: int,
    jump: float,
) -> LightVolumes:
    """Make the shadow volumes of a scene in one light, from a depth map that the light sees.

    The volumes are counted in the picture of `sensor`, by depth-pass: the walls between the camera
    and a point. Depth-fail would also count caps, which would lie on all lit surfaces and darken
    them by mistake.

    resolution : number of texels along a side of the depth map.
    jump : largest change of depth between joined texels [widths of a texel].
    """
    placement = Placement.from_scene(scene, sensor, emitter)
    pixels = max(sensor.film().size())
    return make_volumes_from_depth_map(
        scene, placement, make_pinhole_camera(sensor), resolution, jump, pixels
    )


def make_volumes_from_depth_map(
    scene: MitsubaObject,
    placement: Placement,
    camera: Camera,
    resolution: int,
    jump: float,
    pixels: int,
) -> LightVolumes:
    """Make the shadow volumes of a scene's depth map, to be counted in the picture of a camera.

    resolution : number of texels along a side of the depth map.
    jump : largest change of depth between joined texels [widths of a texel].
    pixels : number of pixels along the longer side of the picture.
    """
    projection = focused.make_projection(placement)
    depths = np.array(render_depths(scene, projection, resolution))
    mesh = make_mesh_from_depths(depths, projection, jump)
    return LightVolumes([mesh], placement.light, camera, "depth_pass", pixels=pixels)


def make_mesh_from_depths(depths: FloatArray, projection: Projection, jump: float) -> Mesh:
    """Return the surface that a depth map shows, as a mesh with a vertex for each texel.

    depths : depths (n, n) of the map, infinite where the light sees no surface.
    projection : the projection by which the map was rendered.
    jump : the surface has a gap where the distance from the light changes between neighbouring
        texels by more than this number of texel widths.
    """
    n = len(depths)
    middles = (np.arange(n) + 0.5) * 2 / n - 1
    x, y = np.meshgrid(middles, middles)
    hit = np.isfinite(depths)
    depths = np.where(hit, depths, 0)
    points = np.stack(projection.unproject(x, y, depths), axis=-1)
    beside = np.stack(projection.unproject(x + 2 / n, y, depths), axis=-1)
    width = np.linalg.norm(beside - points, axis=-1)
    way: Any = projection.light.path_length(*np.moveaxis(points, -1, 0))
    whole = stack_cell_corners(hit).all(axis=0)
    whole &= np.ptp(stack_cell_corners(way), axis=0) <= jump * stack_cell_corners(width).max(axis=0)
    a, b, c, d = stack_cell_corners(np.arange(n * n).reshape(n, n))[:, whole]
    triangles = np.concatenate([np.column_stack([a, b, d]), np.column_stack([a, d, c])])
    return Mesh("the depth map", points.reshape(-1, 3), triangles)


def stack_cell_corners(values: AnyArray) -> AnyArray:
    """Return the values at the four corners of each cell of a grid (n, n), (4, n - 1, n - 1)."""
    return np.stack([values[:-1, :-1], values[:-1, 1:], values[1:, :-1], values[1:, 1:]])
