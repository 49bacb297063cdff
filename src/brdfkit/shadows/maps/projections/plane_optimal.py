"""The shadows on one plane, as the camera sees them, are the map: there it is best (POSM).

Light l takes a point p to the plane π at (π·l) p - (π·p) l, and the camera takes that to the map,
so that a texel is a pixel. It is the projection by five pairs of points: the light, at infinity on
the map, and four of the plane, one of them lifted towards the light [Chong & Gortler 2004],
[Ergun 2008, 2.2.2.5]. Depth is the height over the plane, divided by w.

The camera is moved back until all shadows fall before it, and the map stretched to what it must
hold. The plane is `plane`, or else that face of the scene's box which catches most light, often the
ground. Best on its plane, bad on what stands at right angles to it, such as walls. The focused map
where no face of the scene's box can be the plane, or the eye is in it.
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.homogeneous import project_all
from brdfkit.mitsuba_bridge.properties.declarations import Setting
from brdfkit.shadows.maps.light_camera import fitted
from brdfkit.shadows.maps.projections import focused


def four_numbers(value):
    """`value`, four numbers or a text of them, as an array (4,); None for None or no text."""
    if value is None:
        return None
    numbers = value.split() if isinstance(value, str) else value
    try:
        found = np.array(numbers, float)
    except (TypeError, ValueError):
        found = np.full(1, np.nan)
    if found.shape not in ((0,), (4,)) or not np.isfinite(found).all():
        raise ValueError("four numbers, a b c d, of the plane a x + b y + c z + d = 0")
    return found if found.size else None


PLANE = "of plane_optimal: the receiver's a b c d, where a x + b y + c z + d = 0"
SETTINGS = {"plane": Setting("", None, PLANE, four_numbers)}


def projection(placement, plane):
    if plane is None:
        faces = [face for face in faces_by_light(placement) if takes_shadows(face, placement)]
        return onto(placement, faces[0]) if faces else focused.projection(placement)
    side = np.sign(plane @ placement.light.point)
    plane = plane * side / max(np.linalg.norm(plane[:3]), 1e-30)
    if not takes_shadows(plane, placement):
        raise BrdfkitError(
            "plane_optimal: the plane must cut what the camera sees, and the light be beyond all "
            "that casts shadows on it; choose another plane, or leave it out."
        )
    return onto(placement, plane)


def onto(placement, plane):
    """The `Projection` that is best on a `plane` (4,) that takes the shadows."""
    light, corners = placement.light, placement.body.corners
    flat = (plane @ light.point) * np.eye(4) - np.outer(light.point, plane)
    camera = placement.camera.with_planes(*placement.depths).move_back(project_all(flat, corners))
    if abs(height(plane, camera.position)) < 1e-3 * placement.size:
        return focused.projection(placement)
    matrix = camera.matrix @ flat
    matrix[2] = -plane
    return fitted(matrix, light, corners)


def takes_shadows(plane, placement):
    """Whether a plane cuts what the camera sees, and every shadow falls on it."""
    seen = height(plane, placement.seen.corners)
    aside = 1e-6 * placement.size
    below_light = plane @ placement.light.point
    if not placement.light.is_directional:
        below_light -= height(plane, placement.body.corners).max()
    return below_light > aside and seen.min() < aside and seen.max() > -aside


def faces_by_light(placement):
    """The planes (4,) of the scene's box, normals inwards, the one with most light first."""
    sizes = placement.high - placement.low
    middle = (placement.low + placement.high) / 2
    areas = np.roll(sizes, 1) * np.roll(sizes, 2)
    light = np.abs(placement.light.direction(*middle)) * areas
    return [
        np.append(side * np.eye(3)[axis], -side * end[axis])
        for axis in np.argsort(-light)
        for side, end in ((1, placement.low), (-1, placement.high))
    ]


def height(plane, points):
    """Of points (n, 3) over a plane."""
    return points @ plane[:3] + plane[3]
