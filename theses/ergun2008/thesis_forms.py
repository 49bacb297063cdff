"""Makes projections of shadow maps as the thesis had them, where brdfkit's are others.

The uniform and the light-space perspective projection are those of the engine Ogre, with its
defaults; the perspective and the trapezoidal one are the author's, as far as he describes them
[Ergun 2008, 2.2.2, 4.2]. Focused and plane-optimal maps are the same here and there. None of these
need hold all that casts shadows. Two settings are untold: `near` is the distance of the camera's
near plane, over that of the nearest surface that it sees, and `far` is the distance up to which the
uniform map has shadows, over the farthest depth that is seen.
"""

import numpy as np
from brdfkit.theses.ergun2008.trapezoid import map_trapezoid_to_square

from brdfkit.core.projective.camera import CUBE
from brdfkit.core.projective.homogeneous import (
    make_axes,
    make_rigid_matrix,
    make_unit_cube_matrix,
    project_points,
)
from brdfkit.shadows.comparison.quality import aliasing_error, share_of_texels_used
from brdfkit.shadows.maps.light_camera import view_matrix
from brdfkit.shadows.maps.line_of_sight import find_line_of_sight
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import focused
from brdfkit.shadows.maps.projections.trapezoidal import XI
from brdfkit.shadows.maps.resolution import texel_area_in_pixels

AHEAD = 0.6  # of the distance of shadows: how far before the eye Ogre's window has its middle
STRENGTH = 0.1  # factor of Ogre on the distance n of LiSPSM
NEARLY_ALONG = 0.9  # cosine of view and light above which Ogre weakens LiSPSM
FOCUS = 0.3  # share of what is seen that has 80 % of a trapezoidal map, brdfkit's default


def make_window(placement, far=1.0):
    """Return Ogre's uniform projection: a square window around a place before the eye.

    The window is twice as wide as the distance of shadows. The light is directional.
    """
    camera, light = placement.camera, placement.light
    distance = far * placement.visible_depths[1]
    middle = camera.position + AHEAD * distance * camera.direction
    axes = make_rigid_matrix(make_axes(-light.point[:3]), middle)
    z = project_points(axes, placement.lit_body.corners)[:, 2]
    square = make_unit_cube_matrix([-distance, -distance, z.min()], [distance, distance, z.max()])
    return Projection.from_matrix(square @ axes, light)


def make_symmetric_perspective(placement, near):
    """Return the perspective projection whose light sees the whole unit cube, evenly.

    The field of view is twice the largest angle between the light's axis and a corner of the cube.
    The camera is moved back until its cube holds what may cast shadows.
    """
    z_n, z_f = placement.visible_depths
    camera = placement.camera.replace_near_and_far(near * z_n, z_f)
    camera = camera.move_behind(placement.relevant_body.corners).matrix
    view = view_matrix(camera @ placement.light.point, CUBE, np.zeros(3))
    ends = project_points(view, CUBE)
    half, depths = np.hypot(ends[:, 0], ends[:, 1]).max(), ends[:, 2]
    square = make_unit_cube_matrix([-half, -half, depths.min()], [half, half, depths.max()])
    return Projection.from_matrix(square @ view @ camera, placement.light)


def make_frustum_trapezoid(placement, near):
    """Return the trapezoidal projection: a trapezoid about the camera's frustum on the uniform map.

    It fills the map, whatever the window of the uniform one. Its axis leads through the middles of
    the near and the far plane, and its sides touch the frustum. As the thesis does not say how to
    find them, they are as in [Martin & Tan 2004].
    """
    z_n, z_f = placement.visible_depths
    window = make_window(placement)
    frustum = placement.camera.replace_near_and_far(near * z_n, z_f).find_frustum_corners()
    corners = project_points(window.matrix, frustum)[:, :2]
    axis = corners[4:].mean(axis=0) - corners[:4].mean(axis=0)
    axis /= np.linalg.norm(axis)
    across = np.array([axis[1], -axis[0]])
    x, y = corners @ across, corners @ axis
    top, base = y.min(), y.max()
    length = base - top
    apex = top - length * FOCUS * (1 + XI) / (1 - 2 * FOCUS - XI)
    # The sides lead from the apex, on the axis through the planes' middles, along the outermost
    middle = corners[:4].mean(axis=0) @ across
    slopes = (x - middle) / (y - apex)
    low, high = slopes.min(), slopes.max()
    places = [(low, base), (high, base), (high, top), (low, top)]
    trapezoid = [(middle + s * (y - apex)) * across + y * axis for s, y in places]
    return Projection.from_matrix(
        map_trapezoid_to_square(np.array(trapezoid)) @ window.matrix, placement.light
    )


def make_light_space_perspective(placement, near):
    """Return the light-space perspective projection with Ogre's default distance of the apex."""
    sight = find_line_of_sight(placement)
    if sight is None:
        return focused.make_projection(placement)
    z_n, z_f = placement.visible_depths
    cosine = abs(placement.camera.direction @ placement.light.point[:3])
    weaker = 1 + 20 * max(cosine - NEARLY_ALONG, 0) / (1 - NEARLY_ALONG)
    n = STRENGTH * weaker * (z_n + np.sqrt(near * z_n * z_f))
    return sight.make_warped_projection(n * sight.map_scale)


# Projections by the eye's near plane
BY_NEAR = {
    "perspective": make_symmetric_perspective,
    "light_space_perspective": make_light_space_perspective,
    "trapezoidal": make_frustum_trapezoid,
}


def make_thesis_forms(placement, near):
    """Return the projections of the thesis that are others than ours, by name."""
    by_near = {name: make(placement, near) for name, make in BY_NEAR.items()}
    return {"uniform": make_window(placement)} | by_near


def score_projection(view, projection, resolution):
    """Return the unused share and the aliasing [dB] of a shadow map by a projection in a view."""
    projection, seen = projection.make_opaque(), view.seen
    camera = Projection.from_matrix(
        view.placement.camera.matrix, view.placement.light
    ).make_opaque()
    x, y, _ = projection.project(*seen.si.p)
    picture = camera, seen.size[::-1]
    e = np.array(texel_area_in_pixels((projection, resolution), picture, seen.si.p, seen.si.n))
    places = (np.array([x, y]).T[seen.facing] + 1) / 2
    return 1 - share_of_texels_used([places]), aliasing_error(e[seen.facing])
