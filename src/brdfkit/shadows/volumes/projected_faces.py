"""Faces in a camera's picture, as linear functions over the picture, without any clipping.

A place (x, y) of the picture is the ray d = (x, y, 1). In the camera's space, a corner i of a face
has the homogeneous coordinates (X, Y, Z, w_i); with the slopes s_x and s_y of the field of view,
let v_i = (X / s_x, Y / s_y, -Z). The ray meets the face within its edges, and at the depth z:

    E_i(d) = (v_i × v_{i+1}) · d ≥ 0      (all with one sign, which says the side that is visible)
    1/z    = (w_2 v_0 × v_1 + w_0 v_1 × v_2 + w_1 v_2 × v_0) · d / (v_0 · v_1 × v_2)

so that corners behind the eye and at infinity (w = 0) need no special treatment [Olano & Greer
1997].
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.camera import Camera
from brdfkit.shadows.volumes.volume import Faces


def make_pinhole_camera(sensor: MitsubaObject) -> Camera:
    """Return the camera of a Mitsuba sensor; raise `BrdfkitError` for a sensor with a lens."""
    import mitsuba as mi

    if "aperture_radius" in mi.traverse(sensor):
        raise BrdfkitError(
            "shadow volumes need all camera rays to start at one point, but a thinlens camera's "
            "start on its lens; use a perspective camera."
        )
    return Camera.from_sensor(sensor)


@dataclass(frozen=True)
class ProjectedFaces:
    """Faces of shadow volumes as linear functions of the place (x, y) in a camera's picture.

    edges : (k, 4, 3), the coefficients of x, y and 1 in the edge functions E_i, which are positive
        within a face; scaled so that the largest coefficient is 1.
    ties : (k, 4), the least E_i within a face; it settles which of two faces has their common edge.
    inverse_depth : (k, 3), the coefficients of x, y and 1 in 1/z, z the depth of the face.
    times : (k,), how often a ray counts that meets the face; negative where it leaves the volume.
    """

    edges: AnyArray
    ties: AnyArray
    inverse_depth: AnyArray
    times: AnyArray


def picture_matrix(camera: Camera) -> FloatArray:
    """Return the matrix (4, 4) from the world to the space in which faces are projected.

    A point (X, Y, Z) of the camera's space becomes (X / s_x, Y / s_y, -Z), with the slopes s_x and
    s_y of the field of view, so that the picture is [-1, 1]² at the depth 1.
    """
    matrix: FloatArray = np.diag([1 / camera.slope_x, 1 / camera.slope_y, -1, 1]) @ camera.view
    return matrix


def project_faces(faces: Faces, matrix: FloatArray) -> ProjectedFaces:
    """Return the faces of shadow volumes in a picture, without those that are seen edge-on.

    matrix : (4, 4), from the world to the picture's space, such as a camera's `picture_matrix`.
    """
    corners = faces.corners @ matrix.T
    v, w = corners[..., :3], corners[..., 3]
    crosses = np.cross(v, np.roll(v, -1, axis=1))
    volume = np.einsum("ij,ij->i", v[:, 0], crosses[:, 1])
    plane = w[:, 2, None] * crosses[:, 0] + w[:, 0, None] * crosses[:, 1]
    plane += w[:, 1, None] * np.cross(v[:, 2], v[:, 0])
    visible = volume != 0
    crosses, plane, volume = crosses[visible], plane[visible], volume[visible]
    edges = crosses / np.maximum(np.abs(crosses).max(axis=2, keepdims=True), 1e-300)
    edges = (edges * np.sign(volume)[:, None, None]).astype(np.float32)
    inverse_depth = (plane / volume[:, None]).astype(np.float32)
    times = (np.sign(volume) * faces.times[visible]).astype(int)
    return ProjectedFaces(edges, compute_tie_thresholds(edges), inverse_depth, times)


def compute_tie_thresholds(edges: FloatArray) -> FloatArray:
    """Return the least values (k, 4) of the faces' edge functions at which a point is within.

    The value is 0, or the least positive number: it is 0 where the first coefficient other than 0
    is positive. As the same edge has the opposite sign in the neighbouring face, exactly one of the
    two faces includes the edge, and no ray slips through.
    """
    a, b, c = np.moveaxis(edges, -1, 0)
    leading = np.where(a != 0, a, np.where(b != 0, b, c))
    return np.where(leading >= 0, 0, np.finfo(np.float32).tiny)
