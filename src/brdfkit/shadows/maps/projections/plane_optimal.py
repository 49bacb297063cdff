"""Plane-optimal shadow maps (POSM): a texel is a pixel for the shadows on one plane.

A point p is projected twice. The light l projects it onto the plane π, to the homogeneous point
(π·l) p - (π·p) l. Then the camera projects this point onto the map, as if onto its picture. The
depth of p is its height over the plane, divided by the homogeneous w. [Chong & Gortler 2004],
[Ergun 2008, 2.2.2.5]

The plane is the setting `plane` or, by default, the face of the scene's box that receives most
light, often the ground. The camera is moved back until all shadows fall before it, and the map is
stretched to enclose all that casts or receives shadows. The projection is best on its plane, and
bad on surfaces at right angles to it, such as walls. It is the focused one if no face of the box is
fit to be the plane, or if the eye is in the plane.
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
    """Convert the setting `plane`, four numbers or a text of them, to an array (4,).

    Return None for None or an empty text. Raises `ValueError` for anything else.
    """
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
    """Make the projection that is best on a plane; by default on a face of the scene's box.

    plane : coefficients a, b, c and d of the plane a x + b y + c z + d = 0, or None.

    Raises `BrdfkitError` for a given plane on which the camera cannot see shadows.
    """
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
    """Return the projection that is best for shadows on a `plane` (4,); see `takes_shadows`.

    If the eye is in the plane, it is the focused projection.
    """
    light, corners = placement.light, placement.relevant_body.corners
    flat = (plane @ light.point) * np.eye(4) - np.outer(light.point, plane)
    camera = placement.camera.replace_near_and_far(*placement.visible_depths)
    camera = camera.move_behind(project_points(flat, corners))
    if abs(height_over_plane(plane, camera.position)) < 1e-3 * placement.scene_diagonal:
        return focused.make_projection(placement)
    matrix = camera.matrix @ flat
    matrix[2] = -plane
    return fit_projection(matrix, light, corners)


def takes_shadows(plane: AnyArray, placement: Placement) -> bool:
    """Return whether the camera can see shadows on a plane (4,).

    The plane must cut the visible part of the scene, and nothing may be farther from the plane than
    the light is.
    """
    heights = height_over_plane(plane, placement.visible_body.corners)
    tolerance = 1e-6 * placement.scene_diagonal
    below_light = plane @ placement.light.point
    if not placement.light.is_directional:
        below_light -= height_over_plane(plane, placement.relevant_body.corners).max()
    cuts: Any = heights.min() < tolerance and heights.max() > -tolerance
    return bool(below_light > tolerance and cuts)


def rank_faces_by_light(placement: Placement) -> list[FloatArray]:
    """Return the planes (4,) of the six faces of the scene's box, sorted by the light they receive.

    The face with most light comes first; normals point inwards.
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
    """Return the heights (n,) of points (n, 3) over a plane (4,) whose normal has length 1."""
    return points @ plane[:3] + plane[3]
