"""Rigid motions and uniform scale: what keeps a distance a distance.

[Bálint et al. 2019, chapter 2]
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import plain, turn
from brdfkit.distance_fields.functions import Point, cos, dot, minus, normalized, sin
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import number, vector


class Motion(Node):
    """A node that has the qualities of its child."""

    @property
    def exact_outside(self):
        return self.child.exact_outside

    @property
    def exact_inside(self):
        return self.child.exact_inside

    @property
    def is_convex(self):
        return self.child.is_convex


@dataclass(frozen=True, eq=False, repr=False)
class translate(Motion):
    """A solid moved by a vector.

    Parameters
    ----------
    child : distance field
        The solid.
    offset : three numbers
        The vector.
    """

    child: Node
    offset: Any = vector((0.0, 0.0, 0.0))

    def distance(self, p):
        return self.child.distance(minus(p, self.offset))

    def bounds(self, level=0.0):
        low, high = self.child.bounds(level)
        return low + plain(self.offset), high + plain(self.offset)


@dataclass(frozen=True, eq=False, repr=False)
class rotate(Motion):
    """A solid turned about an axis through the origin.

    Parameters
    ----------
    child : distance field
        The solid.
    angle : number [rad]
        How far, by the right-hand rule.
    axis : three numbers, default (0, 0, 1)
        The axis; of any length.
    """

    child: Node
    angle: Any = number(0.0)
    axis: Any = vector((0.0, 0.0, 1.0))

    def __post_init__(self):
        super().__post_init__()
        if not np.any(plain(self.axis)):
            raise BrdfkitError("rotate.axis = (0, 0, 0) has no direction; give another.")

    def distance(self, p):
        # Rodrigues's formula, for the opposite angle
        u, p = normalized(self.axis), Point(p.x, p.y, p.z)
        c, s = cos(self.angle), sin(self.angle)
        along = (1 - c) * dot(u, p)
        turned = Point(
            c * p.x - s * (u.y * p.z - u.z * p.y) + along * u.x,
            c * p.y - s * (u.z * p.x - u.x * p.z) + along * u.y,
            c * p.z - s * (u.x * p.y - u.y * p.x) + along * u.z,
        )
        return self.child.distance(turned)

    def bounds(self, level=0.0):
        from scipy.spatial.transform import Rotation

        axis = plain(self.axis)
        by = Rotation.from_rotvec(plain(self.angle) * axis / np.linalg.norm(axis))
        return turn(self.child.bounds(level), by.as_matrix())


@dataclass(frozen=True, eq=False, repr=False)
class scale(Motion):
    """A solid scaled about the origin, equally in all directions.

    Parameters
    ----------
    child : distance field
        The solid.
    factor : number > 0
        How many times larger it becomes.
    """

    child: Node
    factor: Any = number(1.0, above=0)

    def distance(self, p):
        smaller = Point(p.x / self.factor, p.y / self.factor, p.z / self.factor)
        return self.factor * self.child.distance(smaller)

    def bounds(self, level=0.0):
        factor = plain(self.factor)
        low, high = self.child.bounds(level / factor)
        return factor * low, factor * high
