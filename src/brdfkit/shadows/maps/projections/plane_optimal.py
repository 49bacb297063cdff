"""A map of the shadows on one plane, as the camera sees them: it is best there (POSM).

A light l takes a point p to the plane π at (π·l) p - (π·p) l, and the camera takes that to the map,
so that a texel is a pixel. It is the projection by five pairs of points: the light, at infinity on
the map, and four of the plane, one of them lifted towards the light [Chong & Gortler 2004], [Ergun
2008, 2.2.2.5]. Depth is the height over the plane, divided by w.

The camera is moved back until all shadows fall before it, and the map is stretched to enclose the
body. The plane is the setting `plane`, or else that face of the scene's box which catches most
light, often the ground. The projection is best on its plane and bad on surfaces at right angles to
it, such as walls. It is the focused one where no face of the scene's box can be the plane, or the
eye is in the plane.
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.homogeneous import project_points
from brdfkit.mitsuba_bridge.properties.declarations import Setting
from brdfkit.shadows.maps.light_camera import fit_projection
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import focused


def parse_plane(value: Any) -> FloatArray | None:
    """Return four numbers, or a text of them, as the plane (4,); None for None or an empty text."""
    if value is None:
        return None
    numbers = value.split() if isinstance(value, str) else value
    try:
        plane = np.array(numbers, float)
    except (TypeError, ValueError):
        plane = np.full(1, np.nan)
    if plane.shape not in ((0,), (4,)) or not np.isfinite(plane).all():
        raise ValueError("four numbers, a b c d, of the plane a x + b y + c z + d = 0")
    return plane if plane.size else None


PLANE = "of plane_optimal: the receiver's a b c d, where a x + b y + c z + d = 0"
SETTINGS = {"plane": Setting("", None, PLANE, parse_plane)}


def make_projection(placement: Placement, plane: FloatArray | None) -> Projection:
    """Make the projection for a `plane` (4,), or for a face of the scene's box if it is None."""
    if plane is None:
        faces = [face for face in rank_faces_by_light(placement) if takes_shadows(face, placement)]
        if not faces:
            return focused.make_projection(placement)
        return project_onto_plane(placement, faces[0])
    side = np.sign(plane @ placement.light.point)
    plane = plane * side / max(float(np.linalg.norm(plane[:3])), 1e-30)
    if not takes_shadows(plane, placement):
        raise BrdfkitError(
            "plane_optimal: the plane must cut the camera's view, and the light must be farther "
            "from it than all that casts shadows; choose another plane, or leave it out."
        )
    return project_onto_plane(placement, plane)


def project_onto_plane(placement: Placement, plane: AnyArray) -> Projection:
    """Return the projection that is best for shadows on a `plane` (4,) that takes them.

    The focused one replaces it if the eye is in the plane.
    """
    light, corners = placement.light, placement.relevant_body.corners
    flat = (plane @ light.point) * np.eye(4) - np.outer(light.point, plane)
    camera = placement.camera.replace_near_and_far(*placement.depths)
    camera = camera.move_behind(project_points(flat, corners))
    if abs(height_over_plane(plane, camera.position)) < 1e-3 * placement.size:
        return focused.make_projection(placement)
    matrix = camera.matrix @ flat
    matrix[2] = -plane
    return fit_projection(matrix, light, corners)


def takes_shadows(plane: AnyArray, placement: Placement) -> bool:
    """Return whether a plane cuts the camera's view and is behind all that casts shadows."""
    heights = height_over_plane(plane, placement.visible_body.corners)
    tolerance = 1e-6 * placement.size
    below_light = plane @ placement.light.point
    if not placement.light.is_directional:
        below_light -= height_over_plane(plane, placement.relevant_body.corners).max()
    cuts: Any = heights.min() < tolerance and heights.max() > -tolerance
    return bool(below_light > tolerance and cuts)


def rank_faces_by_light(placement: Placement) -> list[FloatArray]:
    """Return the planes (4,) of the six faces of the scene's box, the one with most light first.

    Their normals point inwards.
    """
    sizes = placement.high - placement.low
    middle = (placement.low + placement.high) / 2
    areas = np.roll(sizes, 1) * np.roll(sizes, 2)
    light = np.abs(placement.light.direction(*middle)) * areas
    return [
        np.append(side * np.eye(3)[axis], -side * end[axis])
        for axis in np.argsort(-light)
        for side, end in ((1, placement.low), (-1, placement.high))
    ]


def height_over_plane(plane: AnyArray, points: AnyArray) -> Any:
    """Return the heights (n,) of points (n, 3) over a plane (4,)."""
    return points @ plane[:3] + plane[3]
