"""Translation, rotation and uniform scaling, which keep an exact distance exact.

[Bálint et al. 2019, chapter 2]
"""

from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import Box, rotate_box, to_floats
from brdfkit.distance_fields.functions import Point, cos, dot, normalize, sin, subtract
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import number, vector


class Motion(Node):
    """The base of nodes whose field is as exact, and as convex, as their child's."""

    child: Node
    exact_outside = property(attrgetter("child.exact_outside"))
    exact_inside = property(attrgetter("child.exact_inside"))
    is_convex = property(attrgetter("child.is_convex"))


@dataclass(frozen=True, eq=False, repr=False)
class translate(Motion):
    """A solid moved by a vector.

    Parameters
    ----------
    child : distance field
        The solid.
    offset : three numbers, default (0, 0, 0)
        The vector.
    """

    child: Node
    offset: Any = vector((0.0, 0.0, 0.0))

    def distance(self, p: JitVector) -> JitFloat:
        return self.child.distance(subtract(p, self.offset))

    def bounds(self, level: float = 0.0) -> Box:
        low, high = self.child.bounds(level)
        return low + to_floats(self.offset), high + to_floats(self.offset)


@dataclass(frozen=True, eq=False, repr=False)
class rotate(Motion):
    """A solid turned about an axis through the origin.

    Parameters
    ----------
    child : distance field
        The solid.
    angle : number [rad], default 0
        The angle, by the right-hand rule.
    axis : three numbers, default (0, 0, 1)
        The axis, a vector of any length.
    """

    child: Node
    angle: Any = number(0.0)
    axis: Any = vector((0.0, 0.0, 1.0))

    def __post_init__(self) -> None:
        super().__post_init__()
        if not np.any(to_floats(self.axis)):
            raise BrdfkitError("rotate.axis = (0, 0, 0) has no direction; give another axis.")

    def distance(self, p: JitVector) -> JitFloat:
        # Rodrigues's rotation formula for the opposite angle: the child does not move, but p does
        u, p = normalize(self.axis), Point(p.x, p.y, p.z)
        c, s = cos(self.angle), sin(self.angle)
        along = (1 - c) * dot(u, p)
        turned = Point(
            c * p.x - s * (u.y * p.z - u.z * p.y) + along * u.x,
            c * p.y - s * (u.z * p.x - u.x * p.z) + along * u.y,
            c * p.z - s * (u.x * p.y - u.y * p.x) + along * u.z,
        )
        return self.child.distance(turned)

    def bounds(self, level: float = 0.0) -> Box:
        from scipy.spatial.transform import Rotation

        axis = to_floats(self.axis)
        rotation = Rotation.from_rotvec(to_floats(self.angle) * axis / np.linalg.norm(axis))
        return rotate_box(self.child.bounds(level), rotation.as_matrix())


@dataclass(frozen=True, eq=False, repr=False)
class scale(Motion):
    """A solid scaled about the origin, equally in all directions.

    Parameters
    ----------
    child : distance field
        The solid.
    factor : number > 0, default 1
        The ratio of the new size to the old one.
    """

    child: Node
    factor: Any = number(1.0, above=0)

    def distance(self, p: JitVector) -> JitFloat:
        smaller = Point(p.x / self.factor, p.y / self.factor, p.z / self.factor)
        return self.factor * self.child.distance(smaller)

    def bounds(self, level: float = 0.0) -> Box:
        factor = to_floats(self.factor)
        low, high = self.child.bounds(level / factor)
        return factor * low, factor * high
