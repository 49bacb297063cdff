"""Finds position and orientation of a camera from the four corners of the sample in its picture.

A homography, a 3 × 3 matrix, maps the sample's plane z = 0 to the picture [Zhang 2000]. Up to a
common factor, its columns are the sample's x axis r_1, its y axis r_2 and the vector t to its
centre, in coordinates of the camera.
"""

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.pinhole import Pinhole, check_fov

# Largest RMS distance between the sample's corners as given in the photograph and as the fitted
# camera shows them, as a share of the picture's width
TOLERANCE = 0.01


def find_camera(
    places: FloatArray, corners: FloatArray, picture_size: tuple[int, int], fov: float
) -> Pinhole:
    """Return the camera in whose picture the sample's corners appear at the given places.

    `corners` (4, 3) [m] have z = 0, `places` (4, 2) are columns and rows in a picture of
    `picture_size` (width, height) [pixels], and `fov` is the field of view across its width
    [degrees]. Raises `BrdfkitError` if there is no such camera.
    """
    check_fov(fov)
    start = _estimate_pose(_find_ray_slopes(places, picture_size, fov), corners)

    def measure_corner_distances(pose: FloatArray) -> FloatArray:
        """Return how far a camera with the `pose` (6,) projects the corners from their places.

        The result (8,) has differences of columns and rows, in shares of the picture's width.
        """
        projected = _make_pinhole(pose, fov).project(corners, picture_size)
        return np.nan_to_num((projected - places).ravel() / picture_size[0], nan=1e3)

    if np.isfinite(start).all() and start[2] > 0:
        result = least_squares(measure_corner_distances, start, x_scale=[start[2]] * 3 + [1] * 3)
        if np.sqrt((result.fun**2).mean()) < TOLERANCE:
            return _make_pinhole(result.x, fov)
    raise BrdfkitError(
        "no camera of this fov sees a sample of this size so; check their order (upper left, upper "
        "right, lower right, lower left), the fov, and the sample's width and height."
    )


def _find_ray_slopes(places: FloatArray, picture_size: tuple[int, int], fov: float) -> FloatArray:
    """Return the slopes x / z and y / z (4, 2) of the camera's rays through pixels (4, 2)."""
    middle = np.array(picture_size) / 2
    return (places - middle) * [1, -1] / middle[0] * np.tan(np.radians(fov) / 2)


def _estimate_pose(slopes: FloatArray, corners: FloatArray) -> FloatArray:
    """Return an approximate pose of the camera, position and rotation vector (6,), by a homography.

    `slopes` (4, 2) are x / z and y / z of its rays to the sample's `corners` (4, 3) [m].
    """
    rows = []
    for (u, v), (x, y, _) in zip(slopes, corners, strict=True):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y, -u], [0, 0, 0, x, y, 1, -v * x, -v * y, -v]]
    h = np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)
    h *= np.sign(h[2, 2]) / max(np.sqrt(np.linalg.norm(h[:, 0]) * np.linalg.norm(h[:, 1])), 1e-300)
    r_1, r_2, t = h.T
    # scipy's rotations need right-handed axes, so the third row is not forward but backward
    axes = np.column_stack([r_1, r_2, -np.cross(r_1, r_2)]) * [[1], [1], [-1]]
    u, _, v = np.linalg.svd(axes)
    axes = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return np.concatenate([-axes.T @ (t * [1, 1, -1]), Rotation.from_matrix(axes).as_rotvec()])


def _make_pinhole(pose: FloatArray, fov: float) -> Pinhole:
    """Return the camera at the position pose[:3] whose axes are rotated by the vector pose[3:]."""
    _, up, backward = Rotation.from_rotvec(pose[3:]).as_matrix()
    return Pinhole(pose[:3], pose[:3] - np.linalg.norm(pose[:3]) * backward, up, fov)
