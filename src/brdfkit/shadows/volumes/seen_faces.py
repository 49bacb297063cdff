"""Faces as a camera sees them: linear functions over its picture, without any clipping.

A place (x, y) of the picture is the ray of d = (x, y, 1). With corners v_i = (X / s_x, Y / s_y, -Z)
and w_i in the camera's space, the ray meets a face within its edges

    E_i(d) = (v_i × v_{i+1}) · d ≥ 0      (all with one sign, which says the side that is seen)
    1/z    = (w_2 v_0 × v_1 + w_0 v_1 × v_2 + w_1 v_2 × v_0) · d / (v_0 · v_1 × v_2)

so that corners behind the eye and at infinity (w = 0) are as good as others [Olano & Greer 1997].
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.camera import Camera


def pinhole(sensor):
    """The `Camera` of one of Mitsuba's sensors; `BrdfkitError` for one with a lens."""
    import mitsuba as mi

    if "aperture_radius" in mi.traverse(sensor):
        raise BrdfkitError(
            "shadow volumes are counted along rays from one eye, and a thinlens camera has a whole "
            "lens; use a perspective camera."
        )
    return Camera.from_sensor(sensor)


@dataclass(frozen=True)
class SeenFaces:
    """k faces, seen from one place.

    edges : (k, 4, 3), the E_i by their factors of x, y and 1, the largest of them 1.
    ties : (k, 4), the least E_i within: of two faces at an edge, one has the edge itself.
    inverse_depth : (k, 3), 1/z by its factors.
    times : (k,), how often a ray counts that meets it; below 0 where it leaves the volume.
    """

    edges: np.ndarray
    ties: np.ndarray
    inverse_depth: np.ndarray
    times: np.ndarray

    def __len__(self):
        return len(self.times)


def picture_matrix(camera):
    """The matrix (4, 4) from the world to the (X / s_x, Y / s_y, -Z) of a `Camera`."""
    return np.diag([1 / camera.slope_x, 1 / camera.slope_y, -1, 1]) @ camera.view


def seen_faces(faces, matrix):
    """The `Faces` that are seen from a side, as `SeenFaces`.

    matrix : (4, 4), from the world to homogeneous points (v, w); `picture_matrix` of a camera.
    """
    corners = faces.corners @ matrix.T
    v, w = corners[..., :3], corners[..., 3]
    crosses = np.cross(v, np.roll(v, -1, axis=1))
    volume = np.einsum("ij,ij->i", v[:, 0], crosses[:, 1])
    plane = w[:, 2, None] * crosses[:, 0] + w[:, 0, None] * crosses[:, 1]
    plane += w[:, 1, None] * np.cross(v[:, 2], v[:, 0])
    side = volume != 0
    v, crosses, plane, volume = v[side], crosses[side], plane[side], volume[side]
    edges = crosses / np.maximum(np.abs(crosses).max(axis=2, keepdims=True), 1e-300)
    edges = np.float32(edges * np.sign(volume)[:, None, None])
    return SeenFaces(
        edges,
        ties(edges),
        np.float32(plane / volume[:, None]),
        (np.sign(volume) * faces.times[side]).astype(int),
    )


def ties(edges):
    """0 where the first factor that is not 0 is above it, else the least number above 0.

    The same edge has the opposite sign in the face beside it: so one of both includes it, and no
    ray slips through between them.
    """
    a, b, c = np.moveaxis(edges, -1, 0)
    leads = np.where(a != 0, a, np.where(b != 0, b, c))
    return np.where(leads >= 0, 0, np.finfo(np.float32).tiny)
