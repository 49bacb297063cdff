"""Slices whose texels stay where they are as the camera moves and turns (stable cascades).

The map of a slice encloses the ball around it, whose radius does not depend on how the camera is
turned, looks along the light with axes that only the light determines, and moves by whole texels:
so a border of a shadow is made of the same texels from picture to picture, and does not crawl. This
costs resolution: the ball is wider than the slice, and nothing is fitted to what is there
[Valient 2008].

For directional lights. The maps are orthographic whatever the `projection`: one that bends texels
could not keep them. Slices begin at the eye and end at the scene's diagonal, or from outside the
scene at 2, 4, 8 ... times that: radii stay the same between these steps, where they change.
"""

from itertools import pairwise

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.projective.homogeneous import axes_about, rigid, to_unit_cube, transform
from brdfkit.shadow_maps import split_planes
from brdfkit.shadow_maps.partition import Part, Partition
from brdfkit.shadow_maps.projection import Projection

SETTINGS = split_planes.SETTINGS
NEAREST = 1e-3  # the near plane that spacings are reckoned from, over the far one


def partition(scene, placement, project, resolution, parts, spacing):
    if not placement.light.is_directional:
        raise BrdfkitError(
            "stable cascades are of directional lights; of a point or spot light the projection "
            "'uniform' is stable."
        )
    far = farthest(placement)
    planes = split_planes.split_planes(NEAREST * far, far, parts, spacing)
    planes[0] = 0
    maps = [Part(snapped(placement, *ends, resolution), resolution) for ends in pairwise(planes)]
    return Partition(maps, split_planes.by_depth(placement.camera, planes))


def farthest(placement):
    """A depth beyond all that the camera sees, in few steps: the scene's diagonal times 2^k."""
    diagonal = float(np.linalg.norm(placement.high - placement.low))
    return diagonal * 2 ** max(0, np.ceil(np.log2(placement.camera.far / diagonal)))


def snapped(placement, near, far, resolution):
    """The `Projection` along the light that encloses the ball around a slice, at a whole texel."""
    light = placement.light
    view = rigid(axes_about(-light.point[:3]), np.zeros(3))
    depths = transform(view, *placement.scene.corners.T)[2]
    along, radius = ball(placement.camera, near, far)
    centre = transform(view, *(placement.camera.position + along * placement.camera.direction))
    half = radius * resolution / (resolution - 1)  # with room for half a texel of snapping
    texel = 2 * half / resolution
    x, y = (np.round(c / texel) * texel for c in centre[:2])
    low, high = [x - half, y - half, depths.min()], [x + half, y + half, depths.max()]
    return Projection.by(to_unit_cube(low, high) @ view, light)


def ball(camera, near, far):
    """The least ball about a slice: its centre's depth, on the axis of the view, and its radius."""
    t2 = camera.slope_x**2 + camera.slope_y**2
    centre = min(far, (near + far) * (1 + t2) / 2)
    return centre, max(np.hypot(depth - centre, depth * t2**0.5) for depth in (near, far))
