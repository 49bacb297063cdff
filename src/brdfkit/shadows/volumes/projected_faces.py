"""Projects faces of shadow volumes into a camera's picture, without any clipping.

A projected face is a set of functions that are linear over the picture. They tell which camera rays
meet the face, and at which depth. Corners behind the eye and at infinity (w = 0) need no special
treatment [Olano & Greer 1997].

The ray through a place (x, y) of the picture is d = (x, y, 1). A corner i of a face has the
homogeneous coordinates (X, Y, Z, w_i) in the camera's space. Let v_i = (X / s_x, Y / s_y, -Z),
where s_x and s_y are the slopes of the field of view. The ray meets the face if the edge functions
E_i of all its edges have the same sign, which tells the visible side. The depth z there follows
from 1/z:

    E_i(d) = (v_i × v_{i+1}) · d
    1/z    = (w_2 v_0 × v_1 + w_0 v_1 × v_2 + w_1 v_2 × v_0) · d / (v_0 · v_1 × v_2)
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

    edges : coefficients of x, y and 1 in the four edge functions of each face, (k, 4, 3). An edge
        function is positive within the face; its largest coefficient is 1.
    ties : smallest value of each edge function at which a ray meets the face, (k, 4), so that a
        common edge of two faces belongs to only one of them.
    inverse_depth : coefficients of x, y and 1 in 1/z, where z is the depth of the face, (k, 3).
    times : what a ray that meets the face adds to a count, (k,); below 0 where it leaves a volume.
    """

    edges: AnyArray
    ties: AnyArray
    inverse_depth: AnyArray
    times: AnyArray


def picture_matrix(camera: Camera) -> FloatArray:
    """Return the matrix (4, 4) from the world to the space in which faces are projected.

    It is the camera's space, but z is the depth, and x and y are scaled so that the picture is
    [-1, 1]² at the depth 1.
    """
    matrix: FloatArray = np.diag([1 / camera.slope_x, 1 / camera.slope_y, -1, 1]) @ camera.view
    return matrix


def project_faces(faces: Faces, matrix: FloatArray) -> ProjectedFaces:
    """Project faces of shadow volumes into a picture, and leave out faces that are edge-on.

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
    """Return the smallest values of edge functions at which a ray meets the face, (k, 4).

    They decide which of two neighbouring faces a ray through their common edge meets, so that it
    meets exactly one. The value is 0 in one face, which includes the edge, and the smallest
    positive number in the other. The edge function has opposite signs in the two faces; the face in
    which its first nonzero coefficient is positive has the 0.

    edges : coefficients (k, 4, 3) of the edge functions.
    """
    a, b, c = np.moveaxis(edges, -1, 0)
    leading = np.where(a != 0, a, np.where(b != 0, b, c))
    return np.where(leading >= 0, 0, np.finfo(np.float32).tiny)
