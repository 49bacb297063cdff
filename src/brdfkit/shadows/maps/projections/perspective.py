"""A map made in the space behind the camera's own perspective (PSM).

The camera is moved back until all that is visible or casts shadows is before it. Its matrix takes
the light to another place, from which a second camera sees the content of the picture's cube,
fitted on each side. A light behind the eye comes to lie beyond the cube, at w < 0, where its rays
run backwards; depth is negated with its w [Stamminger & Drettakis 2002], [Ergun 2008, 2.2.2.2].

Texels are distributed as the picture's pixels are. The projection is good where nothing is near the
eye; else nearly all of the map is spent there. Every step of the camera moves all texels.
"""

from brdfkit.core.projective.homogeneous import project_points
from brdfkit.shadows.maps.light_camera import fit_projection, view_matrix
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection

NEAREST = 1 / 200  # least ratio of the near to the far plane, as 1/z is too steep near the eye


def make_projection(placement: Placement) -> Projection:
    """Make the projection through the camera's perspective and a camera at the light in it."""
    corners, middle = placement.relevant_body.corners, placement.relevant_body.centroid
    z_n, z_f = placement.depths
    near_camera = placement.camera.replace_near_and_far(max(z_n, NEAREST * z_f), z_f)
    camera = near_camera.move_behind(corners).matrix
    cube, (middle,) = project_points(camera, corners), project_points(camera, [middle])
    light_view = view_matrix(camera @ placement.light.point, cube, middle)
    return fit_projection(light_view @ camera, placement.light, corners)
