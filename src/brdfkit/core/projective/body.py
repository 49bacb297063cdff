"""Convex bodies, by their corners and by their planes: what a light's projection must hold."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.core.errors import BrdfkitError

THINNEST = 1e-9  # the radius of a ball within, over the size, from which on there is a volume


class Empty(BrdfkitError):
    """Nothing that is seen is in the light, so there is nothing to be shadowed."""


@dataclass(frozen=True)
class Body:
    """A convex body of the corners (n, 3) within the planes (m, 4): a·x + d ≤ 0 inside."""

    corners: np.ndarray
    planes: np.ndarray

    @classmethod
    def around(cls, points):
        """The convex hull of points (n, 3).

        Raises `Empty` where they enclose no volume.
        """
        from scipy.spatial import ConvexHull, QhullError

        points = np.asarray(points, float)
        try:
            hull = ConvexHull(points)
        except (QhullError, ValueError) as error:
            raise Empty("the part of the scene to be shadowed has no volume.") from error
        return cls(points[hull.vertices], hull.equations)

    @cached_property
    def middle(self):
        """The centre of its volume (3,), which moves as steadily as the body does."""
        from scipy.spatial import ConvexHull

        inside = self.corners.mean(axis=0)
        sides = self.corners[ConvexHull(self.corners).simplices] - inside
        volumes = np.abs(np.linalg.det(sides))
        return inside + volumes @ sides.sum(axis=1) / (4 * volumes.sum())

    def __and__(self, other):
        """What two bodies share; `Empty` where they share no volume."""
        from scipy.spatial import HalfspaceIntersection

        # about their middle and by their size, since both solvers have tolerances of their own
        middle, size = self.corners.mean(axis=0), np.ptp(self.corners, axis=0).max()
        planes = np.vstack([self.planes, other.planes])
        planes[:, 3] = (planes[:, :3] @ middle + planes[:, 3]) / size
        inside = _find_inner_centre(planes)
        if inside is None:
            raise Empty("no part of the scene is before the camera and in the light.")
        corners = HalfspaceIntersection(planes, inside).intersections
        return Body.around(middle + size * corners)

    def towards(self, light, length):
        """The body with all that lies between it and a `Light`, at least a `length` far."""
        ways = light.point[:3] - light.point[3] * self.corners
        share = 2 * length / max(np.linalg.norm(ways, axis=1).min(), 1e-30)
        # not to the light itself if it is far: hulls of long needles are inexact
        share = share if light.is_directional else min(share, 1)
        return Body.around(np.vstack([self.corners, self.corners + share * ways]))


def make_box(low, high):
    """The `Body` of an axis-aligned box; one without a thickness gets a little."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    least = 1e-4 * max((high - low).max(), 1e-30)
    grown = np.maximum(least - (high - low), 0) / 2
    ends = np.stack([low - grown, high + grown])
    return Body.around([[ends[i, 0], ends[j, 1], ends[k, 2]] for i, j, k in np.ndindex(2, 2, 2)])


def _find_inner_centre(planes):
    """The centre of the largest ball within the planes, of a body of about the size 1; None where
    there is none."""
    from scipy.optimize import linprog

    # maximise r with a·x + |a| r ≤ -d
    norms = np.linalg.norm(planes[:, :3], axis=1)
    system = np.column_stack([planes[:, :3], norms])
    bounds = [(None, None)] * 3 + [(0, None)]
    found = linprog([0, 0, 0, -1], system, -planes[:, 3], bounds=bounds)
    return found.x[:3] if found.success and found.x[3] > THINNEST else None
