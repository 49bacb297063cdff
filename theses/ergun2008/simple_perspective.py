"""Makes perspective shadow maps (PSM) in the simple way that the thesis describes.

The light's view is opened to the whole unit cube, symmetric about its axis, and the camera's near
plane is nearer than anything in view [Ergun 2008, 2.2.2.2].
"""

import numpy as np

from brdfkit.core.projective.homogeneous import make_unit_cube_matrix, project_points
from brdfkit.shadows.comparison.quality import aliasing_error, share_of_texels_used
from brdfkit.shadows.maps.light_camera import view_matrix
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.resolution import texel_area_in_pixels

NEAR = 0.1  # distance of the camera's near plane, over that of the nearest point in view


def make_simple_perspective(placement):
    """Return the `Projection` of a simple perspective shadow map, for a `Placement`."""
    corners, middle = placement.relevant_body.corners, placement.relevant_body.centroid
    z_n, z_f = placement.visible_depths
    camera = placement.camera.replace_near_and_far(NEAR * z_n, z_f).move_behind(corners).matrix
    cube, (centre,) = project_points(camera, corners), project_points(camera, [middle])
    matrix = view_matrix(camera @ placement.light.point, cube, centre) @ camera
    ends = project_points(matrix, corners)
    half, depths = np.abs(ends[:, :2]).max(), ends[:, 2]
    square = make_unit_cube_matrix([-half, -half, depths.min()], [half, half, depths.max()])
    return Projection.from_matrix(square @ matrix, placement.light)


def score_simple_perspective(view, resolution):
    """Return the unused share and the aliasing [dB] of a simple perspective shadow map."""
    projection, seen = make_simple_perspective(view.placement).make_opaque(), view.seen
    camera = Projection.from_matrix(
        view.placement.camera.matrix, view.placement.light
    ).make_opaque()
    x, y, _ = projection.project(*seen.si.p)
    picture = camera, seen.size[::-1]
    e = np.array(texel_area_in_pixels((projection, resolution), picture, seen.si.p, seen.si.n))
    places = (np.array([x, y]).T[seen.facing] + 1) / 2
    return 1 - share_of_texels_used([places]), aliasing_error(e[seen.facing])
