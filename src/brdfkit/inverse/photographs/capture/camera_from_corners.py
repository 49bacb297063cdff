"""Finds where a camera was from the positions of the sample's corners in its picture.

A camera sees the plane z = 0 through a homography H ~ [r_1 r_2 t] [Zhang 2000]. Its columns are the
sample's x and y axes and the vector to the sample's centre, as seen from the camera.
"""

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.pinhole import Pinhole, check_fov

TOLERANCE = (
    0.01  # of the picture's width: the largest RMS distance of the corners from their places
)


def camera_from_corners(
    places: FloatArray, corners: FloatArray, picture_size: tuple[int, int], fov: float
) -> Pinhole:
    """Return the camera that sees the `corners` of the sample at `places` in its picture.

    `corners` (4, 3) [m] have z = 0, `places` (4, 2) are columns and rows in a picture of
    `picture_size` (width, height) [pixels], and `fov` is the angle across its width [degrees].
    Raises `BrdfkitError` if there is no such camera.
    """
    check_fov(fov)
    start = _estimate_pose(_to_slopes(places, picture_size, fov), corners)

    def distances(pose: FloatArray) -> FloatArray:
        """Return how far (8,) the corners are from their places, in widths of the picture."""
        shown = _make_pinhole(pose, fov).project(corners, picture_size)
        return np.nan_to_num((shown - places).ravel() / picture_size[0], nan=1e3)

    if np.isfinite(start).all() and start[2] > 0:
        result = least_squares(distances, start, x_scale=[start[2]] * 3 + [1] * 3)
        if np.sqrt((result.fun**2).mean()) < TOLERANCE:
            return _make_pinhole(result.x, fov)
    raise BrdfkitError(
        "no camera of this fov sees a sample of this size so; check their order (upper left, upper "
        "right, lower right, lower left), the fov, and the sample's width and height."
    )


def _to_slopes(places: FloatArray, picture_size: tuple[int, int], fov: float) -> FloatArray:
    """Return the slopes (4, 2), to the right and upwards, of the rays through `places`."""
    middle = np.array(picture_size) / 2
    return (places - middle) * [1, -1] / middle[0] * np.tan(np.radians(fov) / 2)


def _estimate_pose(slopes: FloatArray, corners: FloatArray) -> FloatArray:
    """Return an approximate pose (6,), position and rotation vector, from a homography."""
    rows = []
    for (u, v), (x, y, _) in zip(slopes, corners, strict=True):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y, -u], [0, 0, 0, x, y, 1, -v * x, -v * y, -v]]
    h = np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)
    h *= np.sign(h[2, 2]) / max(np.sqrt(np.linalg.norm(h[:, 0]) * np.linalg.norm(h[:, 1])), 1e-300)
    r_1, r_2, t = h.T
    # Right, up and forward are left-handed axes, but scipy rotates right-handed ones: use backward
    axes = np.column_stack([r_1, r_2, -np.cross(r_1, r_2)]) * [[1], [1], [-1]]
    u, _, v = np.linalg.svd(axes)
    axes = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return np.concatenate([-axes.T @ (t * [1, 1, -1]), Rotation.from_matrix(axes).as_rotvec()])


def _make_pinhole(pose: FloatArray, fov: float) -> Pinhole:
    """Return the camera at pose[:3] whose axes right, up, backward are rotated by pose[3:]."""
    _, up, backward = Rotation.from_rotvec(pose[3:]).as_matrix()
    return Pinhole(pose[:3], pose[:3] - np.linalg.norm(pose[:3]) * backward, up, fov)
