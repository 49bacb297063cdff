"""Perspective shadow maps (PSM): a map of the scene after the camera's own perspective.

The camera's perspective takes the visible scene to a cube, in which near things are large. The
light is transformed, too, and a second camera at its new place renders the map of the cube. So
texels are distributed as the picture's pixels are [Stamminger & Drettakis 2002], [Ergun 2008,
2.2.2.2].

The camera is first moved back until all that is visible or casts shadows is before it. A light
behind the eye comes to lie beyond the cube, with its homogeneous w < 0, and its rays run backwards;
the sign of w also makes its depths grow away from the light.

The projection is good where nothing is near the eye; else nearly all of the map is spent there.
Every step of the camera moves all texels.
"""

from brdfkit.core.projective.homogeneous import project_points
from brdfkit.shadows.maps.light_camera import fit_projection, view_matrix
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection

NEAREST = 1 / 200  # least ratio of the near to the far plane; below it, most texels are at the eye


def make_projection(placement: Placement) -> Projection:
    """Make the projection by the camera's perspective, then a camera at the transformed light."""
    corners, middle = placement.relevant_body.corners, placement.relevant_body.centroid
    z_n, z_f = placement.visible_depths
    near_camera = placement.camera.replace_near_and_far(max(z_n, NEAREST * z_f), z_f)
    camera = near_camera.move_behind(corners).matrix
    cube, (middle,) = project_points(camera, corners), project_points(camera, [middle])
    light_view = view_matrix(camera @ placement.light.point, cube, middle)
    return fit_projection(light_view @ camera, placement.light, corners)
