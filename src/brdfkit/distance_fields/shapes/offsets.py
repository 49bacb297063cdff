"""Surfaces at a distance from a surface: grown, shrunk, or hollow.

[Bálint et al. 2019, definition 2.6.1]
"""

from dataclasses import dataclass
from typing import Any

from brdfkit.distance_fields.boxes import plain
from brdfkit.distance_fields.functions import absolute
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import number


@dataclass(frozen=True, eq=False, repr=False)
class dilate(Node):
    """A solid grown by a distance: {f ≤ distance}.

    Where f is exact, a grown solid has round edges. Where f is an estimate, the surface may move
    further than the distance.

    Parameters
    ----------
    child : distance field
        The solid.
    radius : number
        How far the surface moves out, or in where it is negative.
    """

    child: Node
    radius: Any = number(0.0)

    @property
    def exact_outside(self):
        return self.child.exact_outside and plain(self.radius) >= 0

    @property
    def exact_inside(self):
        # A point outside the child and inside the grown one is covered from one side alone only
        # where the child is convex
        grown = self.child.is_convex and self.child.exact_outside
        return self.child.exact_inside and (grown or plain(self.radius) <= 0)

    @property
    def is_convex(self):
        return self.child.is_convex

    def distance(self, p):
        return self.child.distance(p) - self.radius

    def bounds(self, level=0.0):
        return self.child.bounds(level + plain(self.radius))


@dataclass(frozen=True, eq=False, repr=False)
class shell(Node):
    """A hollow shell: all points within half a thickness of a surface.

    Parameters
    ----------
    child : distance field
        Has the surface.
    thickness : number > 0
        How thick the shell is.
    """

    child: Node
    thickness: Any = number(0.1, above=0)

    @property
    def exact_outside(self):
        return self.child.exact_outside and self.child.exact_inside

    def distance(self, p):
        return absolute(self.child.distance(p)) - 0.5 * self.thickness

    def bounds(self, level=0.0):
        return self.child.bounds(level + 0.5 * plain(self.thickness))
