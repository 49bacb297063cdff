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
    """A solid grown by a distance: {f ≤ radius}, with the field f of the solid.

    Where f is exact, a grown solid has round edges. Where f is an estimate, the surface may move
    further than the distance.

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
        """True for a child that is exact outside, and grown."""
        return self.child.exact_outside and to_floats(self.radius) >= 0

    @property
    def exact_inside(self) -> bool:
        """True for a child that is exact inside, and shrunk or convex.

        Unless the child is convex, a point between its surface and the grown surface may be nearest
        to a part of the grown surface that f does not account for.
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
        """True if the child is exact on both sides."""
        return self.child.exact_outside and self.child.exact_inside

    def distance(self, p: JitVector) -> JitFloat:
        return absolute(self.child.distance(p)) - 0.5 * self.thickness

    def bounds(self, level: float = 0.0) -> Box:
        return self.child.bounds(level + 0.5 * to_floats(self.thickness))
