"""The map is made in the camera's own space after its perspective (PSM).

The camera is moved back until all that is seen or casts shadows is before it; its matrix takes the
light to another place, and a camera there sees what the picture's cube holds, its frustum fitted on
each side. A light behind the eye comes to be beyond the cube, at w < 0, where its rays run
backwards; depth is negated with its w [Stamminger & Drettakis 2002], [Ergun 2008, 2.2.2.2].

Texels are shared as the picture's pixels are. Good where nothing is near the eye, else nearly all
of the map shows that; and every step of the camera moves all texels.
"""

from brdfkit.core.projective.homogeneous import project_all
from brdfkit.shadows.maps.light_camera import fitted, view

NEAREST = 1 / 200  # of the distances before the camera, over the farthest: depths are as 1 / z


def projection(placement):
    corners, middle = placement.body.corners, placement.body.middle
    z_n, z_f = placement.depths
    camera = placement.camera.with_planes(max(z_n, NEAREST * z_f), z_f).move_back(corners).matrix
    cube, (middle,) = project_all(camera, corners), project_all(camera, [middle])
    seen = view(camera @ placement.light.point, cube, middle)
    return fitted(seen @ camera, placement.light, corners)
