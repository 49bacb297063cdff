"""Where a camera was, from where the corners of the sample are in its picture.

The plane z = 0 is seen through a homography H ~ [r_1 r_2 t] [Zhang 2000], whose columns are the
camera's axes by the sample's x and y, and the way to its middle.
"""

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.pinhole import Pinhole, require_fov

MOST_OFF = 0.01  # of the picture's width, by which corners may be beside where they should be


def camera_from_corners(places, corners, picture_size, fov):
    """The `Pinhole` of `fov` [degrees] that sees `corners` (4, 3) [m], z = 0, at `places` (4, 2),
    columns and rows in a picture of `picture_size` (width, height) [pixels].

    Raises `BrdfkitError` where there is none.
    """
    require_fov(fov)
    width, _ = picture_size
    start = _by_homography(_slopes(places, picture_size, fov), corners)

    def off(x):
        """How far (8,) the corners are off, in widths of the picture."""
        shown = _pinhole(x, fov).project(corners, picture_size)
        return np.nan_to_num((shown - places).ravel() / width, nan=1e3)

    if np.isfinite(start).all() and start[2] > 0:
        found = least_squares(off, start, x_scale=[start[2]] * 3 + [1] * 3)
        if np.sqrt((found.fun**2).mean()) < MOST_OFF:
            return _pinhole(found.x, fov)
    raise BrdfkitError(
        "no camera of this fov sees a sample of this size so; check their order (upper left, upper "
        "right, lower right, lower left), the fov, and the sample's width and height."
    )


def _slopes(places, picture_size, fov):
    """Slopes (4, 2) of the rays through `places`, to the right and upwards."""
    middle = np.array(picture_size) / 2
    return (places - middle) * [1, -1] / middle[0] * np.tan(np.radians(fov) / 2)


def _by_homography(slopes, corners):
    """Place and rotation vector (6,) of the camera that sees `corners` at `slopes`, about."""
    rows = []
    for (u, v), (x, y, _) in zip(slopes, corners, strict=True):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y, -u], [0, 0, 0, x, y, 1, -v * x, -v * y, -v]]
    h = np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)
    h *= np.sign(h[2, 2]) / max(np.sqrt(np.linalg.norm(h[:, 0]) * np.linalg.norm(h[:, 1])), 1e-300)
    r_1, r_2, t = h.T
    # right, up and forward are left-handed, and scipy rotates right-handed axes: -forward is one
    axes = np.column_stack([r_1, r_2, -np.cross(r_1, r_2)]) * [[1], [1], [-1]]
    u, _, v = np.linalg.svd(axes)
    axes = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return np.concatenate([-axes.T @ (t * [1, 1, -1]), Rotation.from_matrix(axes).as_rotvec()])


def _pinhole(x, fov):
    """The `Pinhole` at x[:3], whose axes (right, up, backward) have the rotation vector x[3:]."""
    _, up, backward = Rotation.from_rotvec(x[3:]).as_matrix()
    return Pinhole(x[:3], x[:3] - np.linalg.norm(x[:3]) * backward, up, fov)
