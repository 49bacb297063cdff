"""Copies of a solid around the z axis.

    f(p) = min over k of g(R(2πk/n)⁻¹ p),   R(φ): rotation by φ about z

g is the solid's own field and n the number of copies. As p turns about z, the nearest copy is the
one that is closest in angle. So where g is the exact distance and each copy stays within its own
sector, an n-th of the full turn, only the two copies on both sides of p have to be evaluated.
Otherwise all n are.
"""

from dataclasses import dataclass
from functools import reduce
from itertools import product
from math import atan2 as angle_of
from math import pi
from operator import attrgetter

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitVector
from brdfkit.distance_fields.boxes import EVERYWHERE, Box, join_boxes, rotate_box
from brdfkit.distance_fields.functions import Point, atan2, cos, floor, minimum, sin
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import count


@dataclass(frozen=True, eq=False, repr=False)
class circular_array(Node):
    """A solid and its copies around the z axis, at equal angles.

    Parameters
    ----------
    child : distance field
        The first of the solids, at any place.
    copies : integer ≥ 1, default 1
        The number of solids, the first included.
    """

    child: Node
    copies: int = count(1, least=1)
    exact_outside = property(attrgetter("child.exact_outside"))

    @property
    def exact_inside(self) -> bool:
        """True if the child's field is an exact distance inside, and the copies do not overlap."""
        return self.child.exact_inside and (
            self.copies == 1 or self._angular_extent()[1] < self.sector / 2
        )

    @property
    def is_convex(self) -> bool:
        """True for a single copy of a convex child."""
        return self.child.is_convex and self.copies == 1

    @property
    def sector(self) -> float:
        """The angle [rad] from each copy to the next."""
        return 2 * pi / self.copies

    def distance(self, p: JitVector) -> JitFloat:
        middle, extent = self._angular_extent()
        if self.child.exact_outside and extent <= self.sector / 2 and self.copies > 2:
            first = floor((atan2(p.y, p.x) - middle) / self.sector)
            angles = [first * self.sector, (first + 1.0) * self.sector]
        else:
            angles = [k * self.sector for k in range(self.copies)]
        return reduce(minimum, [self.child.distance(rotate_back_about_z(p, a)) for a in angles])

    def bounds(self, level: float = 0.0) -> Box:
        box = self.child.bounds(level)
        if not np.isfinite(box).all():
            return EVERYWHERE
        matrices = [rotation_matrix(k * self.sector) for k in range(self.copies)]
        return join_boxes([rotate_box(box, matrix) for matrix in matrices])

    def _angular_extent(self) -> tuple[float, float]:
        """Return the angle [rad] of the child's middle around z, and that from there to its ends.

        The second angle is π for a child that contains the axis or is unbounded.
        """
        low, high = self.child.bounds()
        around_axis = (low <= 0)[:2].all() and (high >= 0)[:2].all()
        if around_axis or not np.isfinite([low, high]).all() or (low > high).any():
            return 0.0, pi
        x, y = (low + high)[:2]
        middle = angle_of(y, x)
        corners = product(*np.transpose([low, high])[:2])
        ends = (angle_of(y, x) - middle for x, y in corners)
        return middle, max(abs((end + pi) % (2 * pi) - pi) for end in ends)


def rotate_back_about_z(p: JitVector, angle: JitFloat) -> Point:
    """Return p, rotated about z by -`angle` [rad]."""
    c, s = cos(angle), sin(angle)
    return Point(c * p.x + s * p.y, c * p.y - s * p.x, p.z)


def rotation_matrix(angle: float) -> FloatArray:
    """Return the matrix (3, 3) of a rotation about z by `angle` [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
