"""The camera: it sees all that shows of a volume, from an azimuth and an elevation, head up."""

import numpy as np

FOV = 25.0  # along the shorter side of the picture [degrees]
MARGIN = 1.03  # the picture over what it shows
MOST = 5e4  # voxels of which it is asked whether they show


def direction(volume, azimuth, elevation):
    """The unit vector from a volume to the camera; azimuth and elevation in degrees.

    z is up. An azimuth of 0 is the patient's front, +y in RAS; of other volumes it is -y. It turns
    to the camera's right.

    >>> direction(volume, 90, 0)    # of a scan: from the patient's left
    array([-1.,  0.,  0.])
    """
    turn, lift = np.radians([azimuth, min(max(elevation, -89.99), 89.99)])
    front = 1 if volume.axes == "RAS" else -1
    level = np.cos(lift)
    return np.array([-front * level * np.sin(turn), front * level * np.cos(turn), np.sin(lift)])


def origin_and_target(volume, shows, sides, aspect):
    """Where the camera stands, and what it looks at: the middle of the box about what shows.

    `shows`: the function (volume, k) → which of every k-th voxel do; `sides`: the unit vector to
    the camera, and those of a turn, which tell the distance; `aspect`: width over height.
    """
    points = _shown(volume, shows)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    distance = max(_distance(points - middle, side, aspect) for side in sides[1:] or sides)
    return middle + distance * sides[0], middle


def _distance(from_middle, towards, aspect):
    """How far away a camera sees all points (n, 3)."""
    right = np.cross([0, 0, 1], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)

    # A point p is in the picture of a camera at a distance d if |p · right| ≤ t (d - p · towards)
    t = np.tan(np.radians(FOV / 2)) / MARGIN
    across = np.stack([right / max(aspect, 1), up * min(aspect, 1)])
    needed = np.abs(from_middle @ across.T).max(axis=1) / t + from_middle @ towards
    return needed.max()


def _shown(volume, shows):
    """Corners (n, 3), in the world, of the cells about voxels that show; of every k-th voxel along
    each axis, where they are many. Those of the box where none shows."""
    k = int(np.ceil((volume.values.size / MOST) ** (1 / 3)))
    kji = k * np.argwhere(shows(volume, k))
    if not len(kji):
        kji, k = np.array([[0, 0, 0], volume.values.shape]), 0
    # interpolation reaches to the next voxel, but not out of the box
    cells = kji[:, None] + k * (2 * np.indices((2, 2, 2)).reshape(3, -1).T - 1)
    corners = np.clip(cells.reshape(-1, 3), -0.5, np.array(volume.values.shape) - 0.5)
    return corners[:, ::-1] @ volume.to_world[:3, :3].T + volume.to_world[:3, 3]
