"""Copies of a solid all around the z axis.

    f(p) = min over k of g(R(2πk/n)⁻¹ p),   R(φ) turns by φ about z

Where each copy keeps to its own sector, an n-th of the full turn, those two are enough whose
sectors' middles are on the two sides of p: to a point that turns about z, the nearest of its copies
is the one that is least away in angle. This holds for distances, not for estimates g, of which all
n are taken, as they are of a solid that reaches out of its sector.
"""

from dataclasses import dataclass
from functools import reduce
from itertools import product
from math import atan2 as angle_of
from math import pi

import numpy as np

from brdfkit.distance_fields.boxes import EVERYWHERE, join, turn
from brdfkit.distance_fields.functions import Point, atan2, cos, floor, minimum, sin
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import count


@dataclass(frozen=True, eq=False, repr=False)
class circular_array(Node):
    """A solid and its copies around the z axis, at equal angles.

    Parameters
    ----------
    child : distance field
        The first of them; anywhere.
    copies : integer ≥ 1
        How many there are.
    """

    child: Node
    copies: int = count(1, least=1)

    @property
    def exact_outside(self):
        return self.child.exact_outside

    @property
    def exact_inside(self):
        return self.child.exact_inside and (self.copies == 1 or self._reach()[1] < self.sector / 2)

    @property
    def is_convex(self):
        return self.child.is_convex and self.copies == 1

    @property
    def sector(self) -> float:
        """The angle [rad] from each copy to the next."""
        return 2 * pi / self.copies

    def distance(self, p):
        middle, reach = self._reach()
        if self.child.exact_outside and reach <= self.sector / 2 and self.copies > 2:
            first = floor((atan2(p.y, p.x) - middle) / self.sector)
            angles = [first * self.sector, (first + 1.0) * self.sector]
        else:
            angles = [k * self.sector for k in range(self.copies)]
        return reduce(minimum, [self.child.distance(turned_back(p, a)) for a in angles])

    def bounds(self, level=0.0):
        box = self.child.bounds(level)
        if not np.isfinite(box).all():
            return EVERYWHERE
        return join([turn(box, matrix(k * self.sector)) for k in range(self.copies)])

    def _reach(self):
        """The angles [rad] of the child's middle, and from there to its ends; π about the axis."""
        low, high = self.child.bounds()
        around_axis = (low <= 0)[:2].all() and (high >= 0)[:2].all()
        if around_axis or not np.isfinite([low, high]).all() or (low > high).any():
            return 0.0, pi
        x, y = (low + high)[:2]
        middle = angle_of(y, x)
        corners = product(*np.transpose([low, high])[:2])
        ends = (angle_of(y, x) - middle for x, y in corners)
        return middle, max(abs((end + pi) % (2 * pi) - pi) for end in ends)


def turned_back(p, angle):
    """p, turned about z by the opposite `angle`."""
    c, s = cos(angle), sin(angle)
    return Point(c * p.x + s * p.y, c * p.y - s * p.x, p.z)


def matrix(angle):
    """R(angle), (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
