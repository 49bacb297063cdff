"""Slices of the view whose texels stay in place as the camera moves and turns (stable cascades).

The map of a slice encloses the ball around it, whose radius does not depend on how the camera is
turned. It looks along the light, with axes that only the light determines, and moves by whole
texels. So a border of a shadow is made of the same texels from picture to picture, and does not
crawl [Valient 2008]. The ball is wider than the slice, and nothing is fitted to the scene. Three
things make up for most of that:

- A point uses the finest map that contains it, not that of its slice.
- Slices begin and end where the visible surfaces do, but only at 1, 2, 4, 8 ... times a fraction of
  the scene's diagonal: radii stay the same until an end jumps to the next step.
- A map that would be wider than the scene is as wide as the scene, and a map near the scene's
  border does not reach beyond it.

Of the light in the scenes foliage, objects_on_a_ground and street, 3.9, 0.36 and 0.27 % is wrong
with four maps of 512². With `parallel_split` it is 3.6, 0.31 and 0.35 %, with one focused map of
1024² 4.0, 0.33 and 1.3 %. As the camera moves, the error changes 100 times less than with either.

The partition is for directional lights. The maps are orthographic whatever the `projection`: one
that bends texels could not keep them in place.
"""

from collections.abc import Callable
from itertools import pairwise

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitInt, JitVector, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.homogeneous import (
    make_axes,
    make_rigid_matrix,
    make_unit_cube_matrix,
    transform,
)
from brdfkit.shadows.maps import split_planes
from brdfkit.shadows.maps.cells import GUTTER
from brdfkit.shadows.maps.partition import Part, Partition, Setup
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.visible_surfaces import find_visible_surfaces

SETTINGS = split_planes.SETTINGS
MARGIN = 0.05  # share of the depths; surfaces between the rays may be nearer or farther by it
ROUNDING_ERROR = 1e-5  # the rounding error of coordinates on a map, which has the width 2


def make_partition(setup: Setup, parts: int, spacing: str) -> Partition:
    """Make a partition of `parts` stable slices of the camera's view.

    Raises `BrdfkitError` unless the light is directional.
    """
    placement, resolution = setup.placement, setup.resolution
    if not placement.light.is_directional:
        raise BrdfkitError(
            "stable cascades need a directional light; for a point or spot light use the "
            "projection 'uniform', whose texels stay in place, too."
        )
    near, far = find_stable_depths(setup.scene, placement)
    planes = split_planes.compute_split_planes(near, far, parts, spacing)
    maps = [snap_projection(placement, *pair, resolution) for pair in pairwise(planes)]
    return Partition([Part(each, resolution) for each in maps], make_map_finder(maps, resolution))


def find_stable_depths(scene: MitsubaObject, placement: Placement) -> tuple[float, float]:
    """Return a depth before and a depth behind all surfaces that the camera sees.

    Both are the scene's diagonal times a power of 2, so that they seldom change as the camera
    moves.
    """
    depths = placement.camera.compute_depths(find_visible_surfaces(scene, placement.camera).points)
    near, far = (1 - MARGIN) * depths.min(), (1 + MARGIN) * depths.max()
    size = placement.size
    return size * 2 ** np.floor(np.log2(near / size)), size * 2 ** np.ceil(np.log2(far / size))


def snap_projection(placement: Placement, near: float, far: float, resolution: int) -> Projection:
    """Return the projection along the light around a slice's ball, moved to whole texels.

    near, far : depths of the slice along the camera's view.
    """
    light, camera = placement.light, placement.camera
    view = make_rigid_matrix(make_axes(-light.point[:3]), np.zeros(3))
    *sides, depths = transform(view, *placement.lit_body.corners.T)[:3]
    along, radius = bounding_ball(camera, near, far)
    centre = transform(view, *(camera.position + along * camera.direction))
    ends = [
        snap_map_range(place, radius, side, resolution)
        for place, side in zip(centre[:2], sides, strict=True)
    ]
    low, high = np.transpose([*ends, (depths.min(), depths.max())])
    return Projection.from_matrix(make_unit_cube_matrix(low, high) @ view, light)


def snap_map_range(
    place: float, radius: float, side: FloatArray, resolution: int
) -> tuple[float, float]:
    """Return both ends of a map along one axis across the light, snapped to whole texels.

    The map encloses the ball of a slice, but is not wider than the scene.

    place : coordinate of the ball's centre.
    radius : radius of the ball.
    side : coordinates (8,) of the scene's corners.
    """
    radius = min(radius, float(np.ptp(side)) / 2)
    place = np.clip(place, side.min() + radius, side.max() - radius)
    # The ball leaves half a texel on each side for snapping, and the gutter that filters read
    texel = 2 * radius / max(resolution - 2 * GUTTER - 1, 1)
    middle = np.round(place / texel) * texel
    return middle - texel * resolution / 2, middle + texel * resolution / 2


def bounding_ball(camera: Camera, near: float, far: float) -> tuple[float, float]:
    """Return the smallest ball around a slice of the view: its centre's depth and its radius."""
    t2 = camera.slope_x**2 + camera.slope_y**2
    centre = min(far, (near + far) * (1 + t2) / 2)
    return centre, max(np.hypot(depth - centre, depth * t2**0.5) for depth in (near, far))


def make_map_finder(maps: list[Projection], resolution: int) -> Callable[[JitVector], JitInt]:
    """Return a function that finds the index of the first map that contains a point.

    Points near the edge of a map do not count as inside, so that filters do not read beyond it.
    """
    import mitsuba as mi

    opaque = [each.make_opaque() for each in maps]
    edge: JitFloat = dr.opaque(mi.Float, 1 - 2 * GUTTER / resolution + ROUNDING_ERROR)

    def find_map(p: JitVector) -> JitInt:
        index: JitInt = mi.UInt32(len(opaque))
        for i in reversed(range(len(opaque))):
            x, y, _ = opaque[i].project(*p)
            index = dr.select((dr.abs(x) <= edge) & (dr.abs(y) <= edge), mi.UInt32(i), index)
        return index

    return find_map
