"""Solids about a segment from `a` to `b`: capsule, cylinder, cone. Their distances are exact.

[Bálint et al. 2019, chapter 2], in which the segment is a capsule of radius 0
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import around, join, plain
from brdfkit.distance_fields.functions import (
    Point,
    absolute,
    clip,
    dot,
    length,
    maximum,
    minimum,
    minus,
    select,
)
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import number, vector

FOOT, TOP = (0.0, 0.0, -0.5), (0.0, 0.0, 0.5)


class Rod(Node):
    """A solid about a segment from `a` to `b`, whose f is its distance."""

    exact_outside = exact_inside = is_convex = True

    def __post_init__(self):
        super().__post_init__()
        if np.array_equal(plain(self.a), plain(self.b)):
            raise BrdfkitError(f"{self.kind}: a and b are one point; its ends should be two.")

    def along(self, p):
        """Where the segment is nearest to `p`: from 0 at `a` to 1 at `b`, and beyond.

        Also the vectors from `a` to `p` and to `b`, and the segment's squared length.
        """
        ba = [b - a for a, b in zip(self.a, self.b, strict=True)]
        pa = minus(p, self.a)
        squared = dot(ba, ba)
        return dot(pa, ba) / squared, pa, Point(*ba), squared


@dataclass(frozen=True, eq=False, repr=False)
class capsule(Rod):
    """All points within a distance of a segment; the segment itself where that is 0.

    Parameters
    ----------
    a, b : three numbers, default (0, 0, -0.5) and (0, 0, 0.5)
        The ends of the segment.
    radius : number ≥ 0, default 0.25
        The distance.
    """

    a: Any = vector(FOOT)
    b: Any = vector(TOP)
    radius: Any = number(0.25, least=0)

    def distance(self, p):
        t, pa, ba, _ = self.along(p)
        return length(*across(pa, ba, clip(t, 0.0, 1.0))) - self.radius

    def bounds(self, level=0.0):
        return around(plain(self.a), plain(self.b), reach=plain(self.radius) + level)


@dataclass(frozen=True, eq=False, repr=False)
class capped_cylinder(Rod):
    """A cylinder with flat ends.

    Parameters
    ----------
    a, b : three numbers, default (0, 0, -0.5) and (0, 0, 0.5)
        The centres of the ends.
    radius : number > 0, default 0.5
        Its radius.
    """

    a: Any = vector(FOOT)
    b: Any = vector(TOP)
    radius: Any = number(0.5, above=0)

    def distance(self, p):
        t, pa, ba, squared = self.along(p)
        x = length(*across(pa, ba, t)) - self.radius
        y = (absolute(t - 0.5) - 0.5) * _root(squared)
        return length(maximum(x, 0.0), maximum(y, 0.0)) + minimum(maximum(x, y), 0.0)

    def bounds(self, level=0.0):
        return _between_discs(self, (self.radius, self.radius), level)


@dataclass(frozen=True, eq=False, repr=False)
class capped_cone(Rod):
    """A cone, or what two cuts leave of one, with flat ends.

    Parameters
    ----------
    a, b : three numbers, default (0, 0, -0.5) and (0, 0, 0.5)
        The centres of the ends.
    radius_a, radius_b : number ≥ 0, default 0.5 and 0
        The radii of the ends, of which one at most is 0.
    """

    a: Any = vector(FOOT)
    b: Any = vector(TOP)
    radius_a: Any = number(0.5, least=0)
    radius_b: Any = number(0.0, least=0)

    def __post_init__(self):
        super().__post_init__()
        if plain(self.radius_a) == plain(self.radius_b) == 0:
            raise BrdfkitError("capped_cone: both radii are 0; a capsule of radius 0 is a segment.")

    def distance(self, p):
        t, pa, ba, squared = self.along(p)
        x = length(*across(pa, ba, t))
        widening = self.radius_b - self.radius_a
        # To the nearer end: across and along
        end_x = maximum(select(t < 0.5, x - self.radius_a, x - self.radius_b), 0.0)
        end_y = (absolute(t - 0.5) - 0.5) * _root(squared)
        # To the nearest point of the side, which is a share of the way from a to b
        share = (widening * (x - self.radius_a) + t * squared) / (widening * widening + squared)
        share = clip(share, 0.0, 1.0)
        side_x = x - self.radius_a - share * widening
        side_y = (t - share) * _root(squared)
        nearest = minimum(length(end_x, end_y), length(side_x, side_y))
        inside = (side_x < 0.0) & (end_y < 0.0)
        return select(inside, -nearest, nearest)

    def bounds(self, level=0.0):
        return _between_discs(self, (self.radius_a, self.radius_b), level)


def across(pa, ba, t):
    """The vector to a point from the place `t` of its segment."""
    return pa.x - t * ba.x, pa.y - t * ba.y, pa.z - t * ba.z


def _root(value):
    """√value of the squared length of a segment, never 0."""
    return value**0.5


def _between_discs(rod, radii, level):
    """The box around two discs, the ends of `rod`, and `level` further."""
    a, b = plain(rod.a), plain(rod.b)
    axis = (b - a) / np.linalg.norm(b - a)
    extent = np.sqrt(np.maximum(1 - axis**2, 0))  # of a unit disc across the axis
    discs = [
        around(end + extent * plain(radius), end - extent * plain(radius), reach=level)
        for end, radius in zip((a, b), radii, strict=True)
    ]
    return join(discs)
