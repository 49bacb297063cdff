"""Places the camera so that the picture contains all visible parts of a volume, upright."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.volumes import Volume

# A function that receives a volume and k. It tests every k-th voxel along each axis, and returns a
# mask of the tested voxels, True for visible ones
VisibilityTest: TypeAlias = Callable[[Volume, int], BoolArray]

FOV = 25.0  # angle of view along the picture's shorter side [degrees]
STEEPEST = 89.99  # elevation of a camera [degrees]: at 90 "up" would have no direction
MARGIN = 1.03  # size of the picture, divided by the size of the volume's visible parts in it
TESTED_VOXELS = 5e4  # approximate largest number of voxels that are tested for visibility


def camera_direction(volume: Volume, azimuth: float, elevation: float) -> FloatArray:
    """Return the unit vector (3,) from a volume to the camera; the angles are in degrees.

    z points up. At azimuth 0 the camera is in front of the patient, at +y in RAS coordinates
    (right, anterior, superior); for other volumes it is at -y. A larger azimuth moves the camera to
    its right.

    >>> camera_direction(volume, 90, 0)    # the patient's left, if the volume is a scan
    array([-1.,  0.,  0.])
    """
    return to_direction(azimuth, elevation, find_front(volume))


def find_front(volume: Volume) -> int:
    """Return the sign of the y axis on which a volume's front is: 1 in RAS coordinates, else -1."""
    return 1 if volume.axes == "RAS" else -1


def to_direction(azimuth: float, elevation: float, front: int = -1) -> FloatArray:
    """Return the unit vector (3,) at an azimuth and an elevation [degrees], see `camera_direction`.

    `front` is the sign of the y axis that has the azimuth 0.
    """
    turn, lift = np.radians([azimuth, min(max(elevation, -STEEPEST), STEEPEST)])
    level = np.cos(lift)
    return np.array([-front * level * np.sin(turn), front * level * np.cos(turn), np.sin(lift)])


def place_camera(
    volume: Volume, is_visible: VisibilityTest, sides: list[FloatArray], aspect: float
) -> tuple[FloatArray, FloatArray]:
    """Return the camera's position (3,) and its target, the middle of the box of the visible parts.

    `is_visible` finds the visible voxels. `sides` begins with the unit vector from the volume to
    the camera. If more vectors follow, for a turn around the volume, the distance is large enough
    for all of them. `aspect` is the picture's width divided by its height.
    """
    points = _find_visible_corners(volume, is_visible)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    distance = max(
        _find_camera_distance(points - middle, side, aspect) for side in sides[1:] or sides
    )
    return middle + distance * sides[0], middle


def _find_camera_distance(from_middle: FloatArray, towards: FloatArray, aspect: float) -> float:
    """Return the smallest distance from which a camera sees all points (n, 3).

    The points are relative to the camera's target; `towards` is the unit vector to the camera.
    """
    right = np.cross([0, 0, 1], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)

    # The picture shows a point p if |p · right| and |p · up| ≤ t (d - p · towards), where d is the
    # camera's distance; solve for d
    t = np.tan(np.radians(FOV / 2)) / MARGIN
    across = np.stack([right / max(aspect, 1), up * min(aspect, 1)])
    needed = np.abs(from_middle @ across.T).max(axis=1) / t + from_middle @ towards
    return float(needed.max())


def _find_visible_corners(volume: Volume, is_visible: VisibilityTest) -> FloatArray:
    """Return corners (n, 3), in world coordinates, of the cells around all visible voxels.

    Of a large volume, every k-th voxel along each axis is tested. If no voxel is visible, the
    corners of the whole box are returned.
    """
    k = int(np.ceil((volume.values.size / TESTED_VOXELS) ** (1 / 3)))
    kji = k * np.argwhere(is_visible(volume, k))
    if not len(kji):
        kji, k = np.array([[0, 0, 0], volume.values.shape]), 0
    # A visible voxel is seen up to the next tested voxels on all sides, but not beyond the box
    cells = kji[:, None] + k * (2 * np.indices((2, 2, 2)).reshape(3, -1).T - 1)
    corners = np.clip(cells.reshape(-1, 3), -0.5, np.array(volume.values.shape) - 0.5)
    return corners[:, ::-1] @ volume.to_world[:3, :3].T + volume.to_world[:3, 3]
