"""Guesses which axis of a mesh points up, y or z, by the one on which it stands."""

import numpy as np

FOOT = 0.02  # of the height: what is so near to the lowest point touches the ground
SHARE = 0.1  # of the outline from above that a foot has at least


def guess_up(points):
    """ "z" for vertices (n, 3) that stand upright with z up and not with y up, else "y".

    Files of meshes do not say which axis is up. A solid stands where the middle of its convex hull
    is above its foot, the convex polygon around what touches the ground, and where that foot is no
    mere tip. What stands both ways, as a cube, or neither way, as a sheet, has y up, which is the
    custom of OBJ files.
    """
    return "z" if _stands(points, 2) and not _stands(points, 1) else "y"


def _stands(points, axis):
    """Whether a solid of these vertices stands with this `axis` up."""
    from scipy.spatial import ConvexHull, QhullError

    level = [k for k in range(3) if k != axis]
    height = points[:, axis] - points[:, axis].min()
    try:
        hull = ConvexHull(points)
        foot = ConvexHull(points[height < FOOT * height.max()][:, level])
        outline = ConvexHull(points[:, level])
    except (QhullError, ValueError):  # flat, or it touches the ground in too few points
        return False
    corners = points[hull.simplices] - points[hull.vertices].mean(axis=0)
    volumes = np.abs(np.linalg.det(corners))
    middle = points[hull.vertices].mean(axis=0) + volumes @ corners.sum(axis=1) / 4 / volumes.sum()
    inside = np.all(foot.equations @ np.append(middle[level], 1) < 0)
    return bool(inside and foot.volume > SHARE * outline.volume)  # a polygon's volume: its area
