"""Solids bounded by offset surfaces: grown, shrunk, or hollow.

[Bálint et al. 2019, definition 2.6.1]
"""

from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.distance_fields.boxes import Box, to_floats
from brdfkit.distance_fields.functions import absolute
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import number


@dataclass(frozen=True, eq=False, repr=False)
class dilate(Node):
    """A solid grown by a distance on all sides.

    A field that is the exact distance makes round edges. Where the child's field is an estimate,
    the surface may move further than the distance.

    Parameters
    ----------
    child : distance field
        The solid.
    radius : number, default 0
        The distance by which the surface moves out, or in where it is negative.
    """

    child: Node
    radius: Any = number(0.0)
    is_convex = property(attrgetter("child.is_convex"))

    @property
    def exact_outside(self) -> bool:
        """True if the child's field is an exact distance outside, and the child is grown."""
        return self.child.exact_outside and to_floats(self.radius) >= 0

    @property
    def exact_inside(self) -> bool:
        """True if the child's field is an exact distance inside, and the child is shrunk or convex.

        Unless the child is convex, its distances do not tell how far inner points are from the
        grown surface.
        """
        grown = self.child.is_convex and self.child.exact_outside
        return self.child.exact_inside and (grown or to_floats(self.radius) <= 0)

    def distance(self, p: JitVector) -> JitFloat:
        return self.child.distance(p) - self.radius

    def bounds(self, level: float = 0.0) -> Box:
        return self.child.bounds(level + to_floats(self.radius))


@dataclass(frozen=True, eq=False, repr=False)
class shell(Node):
    """A hollow shell: all points within half a thickness of a surface.

    Parameters
    ----------
    child : distance field
        The solid with that surface.
    thickness : number > 0, default 0.1
        The thickness of the shell.
    """

    child: Node
    thickness: Any = number(0.1, above=0)

    @property
    def exact_outside(self) -> bool:
        """True if the child's field is an exact distance on both sides of its surface."""
        return self.child.exact_outside and self.child.exact_inside

    def distance(self, p: JitVector) -> JitFloat:
        return absolute(self.child.distance(p)) - 0.5 * self.thickness

    def bounds(self, level: float = 0.0) -> Box:
        return self.child.bounds(level + 0.5 * to_floats(self.thickness))
