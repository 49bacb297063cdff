"""Stable cascades: slices of the view whose texels stay in place as the camera moves and turns.

The view is divided by depth into slices with a map each. The map of a slice encloses the smallest
ball around the slice, whose radius does not depend on how the camera is turned. The map's axes
depend on the light alone, and the map moves by whole texels. So a border of a shadow is made of the
same texels from picture to picture, and does not crawl [Valient 2008].

The price is coarser texels, as the ball is wider than the slice, and nothing is fitted to the
scene. Three things make up for most of this:

- A point uses the finest map that contains it, not that of its slice.
- Slices begin and end where the visible surfaces do, rounded to the scene's diagonal times a power
  of 2: the radii stay the same until an end jumps to the next power.
- A map that would be wider than the scene is as wide as the scene, and a map near the scene's
  border does not reach beyond it.

In the scenes foliage, objects_on_a_ground and street, 3.9, 0.36 and 0.27 % of the light is wrong
with four maps of 512². With `parallel_split` it is 3.6, 0.31 and 0.35 %, and with a single focused
map of 1024² it is 4.0, 0.33 and 1.3 %. As the camera moves, the error changes 100 times less than
with either.

The partition is for directional lights. The maps are orthographic whatever the `projection`, as a
warped map could not keep texels in place.
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
MARGIN = 0.05  # share of a depth by which surfaces between camera rays may be nearer or farther
ROUNDING_ERROR = 1e-5  # rounding error of map coordinates, which are from -1 to 1


def make_partition(setup: Setup, parts: int, spacing: str) -> Partition:
    """Make a partition of the camera's view into `parts` slices, each with a stable map.

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
    """Return a depth before all surfaces that the camera sees, and a depth behind them.

    Each is the scene's diagonal times a power of 2, so that it seldom changes as the camera moves.
    """
    depths = placement.camera.compute_depths(find_visible_surfaces(scene, placement.camera).points)
    near, far = (1 - MARGIN) * depths.min(), (1 + MARGIN) * depths.max()
    size = placement.scene_diagonal
    return size * 2 ** np.floor(np.log2(near / size)), size * 2 ** np.ceil(np.log2(far / size))


def snap_projection(placement: Placement, near: float, far: float, resolution: int) -> Projection:
    """Return the projection of a slice's map, moved to whole texels so that they stay in place.

    near, far : depths along the camera's view between which the slice lies.
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
    """Return both ends of a slice's map on one of its axes, snapped to whole texels.

    The map encloses the ball around the slice, but is not wider than the scene.

    place : coordinate of the ball's centre on the axis.
    radius : radius of the ball.
    side : coordinates (8,) of the corners of the scene's box on the axis.
    """
    radius = min(radius, float(np.ptp(side)) / 2)
    place = np.clip(place, side.min() + radius, side.max() - radius)
    # On each side of the ball remain half a texel for snapping, and the texels that filters read
    texel = 2 * radius / max(resolution - 2 * GUTTER - 1, 1)
    middle = np.round(place / texel) * texel
    return middle - texel * resolution / 2, middle + texel * resolution / 2


def bounding_ball(camera: Camera, near: float, far: float) -> tuple[float, float]:
    """Return the smallest ball around a slice of the view: the depth of its centre, and its radius.

    near, far : depths along the camera's view between which the slice lies.
    """
    t2 = camera.slope_x**2 + camera.slope_y**2
    centre = min(far, (near + far) * (1 + t2) / 2)
    return centre, max(np.hypot(depth - centre, depth * t2**0.5) for depth in (near, far))


def make_map_finder(maps: list[Projection], resolution: int) -> Callable[[JitVector], JitInt]:
    """Return a function that finds the index of the first map that contains a point.

    Points near the edge of a map count as outside, so that filters do not read beyond the edge.
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
