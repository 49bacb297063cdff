"""Solids around a segment from `a` to `b`: capsule, cylinder, cone. Their distances are exact.

[Bálint et al. 2019, chapter 2], where a segment is a capsule of radius 0
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import Box, bound_points, join_boxes, to_floats
from brdfkit.distance_fields.functions import (
    absolute,
    clip,
    dot,
    length,
    maximum,
    minimum,
    select,
    subtract,
)
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import number, vector


@dataclass(frozen=True, eq=False, repr=False)
class Rod(Node):
    """The base of convex solids around a segment from `a` to `b`, whose distance is exact."""

    a: Any = vector((0.0, 0.0, -0.5))
    b: Any = vector((0.0, 0.0, 0.5))
    exact_outside = exact_inside = is_convex = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.array_equal(to_floats(self.a), to_floats(self.b)):
            raise BrdfkitError(f"{self.kind}: a and b are the same point; give two different ones.")

    def _project_onto_segment(
        self, p: JitVector, clipped: bool = False
    ) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Return the place t of `p` along the segment, the distance from `p` to it, and ‖b - a‖².

        t is 0 at `a` and 1 at `b`; it goes on beyond the segment's ends unless `clipped`.
        """
        ba = [b - a for a, b in zip(self.a, self.b, strict=True)]
        pa = subtract(p, self.a)
        squared = dot(ba, ba)
        t = dot(pa, ba) / squared
        if clipped:
            t = clip(t, 0.0, 1.0)
        return t, length(*(q - t * edge for q, edge in zip(pa, ba, strict=True))), squared

    def _bound_discs(self, radius_a: JitFloat, radius_b: JitFloat, level: float) -> Box:
        """Return the box around the discs at both ends of the segment, grown by `level`."""
        a, b = to_floats(self.a), to_floats(self.b)
        axis = (b - a) / np.linalg.norm(b - a)
        unit = np.sqrt(np.maximum(1 - axis**2, 0))  # half the size of the box around a unit disc
        extents = unit * to_floats(radius_a), unit * to_floats(radius_b)
        discs = zip((a, b), extents, strict=True)
        return join_boxes([bound_points(end + e, end - e, margin=level) for end, e in discs])


@dataclass(frozen=True, eq=False, repr=False)
class capsule(Rod):
    """All points within a distance of a segment; the segment itself if the distance is 0.

    Parameters
    ----------
    a, b : three numbers, default (0, 0, -0.5) and (0, 0, 0.5)
        The ends of the segment.
    radius : number ≥ 0, default 0.25
        The distance.
    """

    radius: Any = number(0.25, least=0)

    def distance(self, p: JitVector) -> JitFloat:
        return self._project_onto_segment(p, clipped=True)[1] - self.radius

    def bounds(self, level: float = 0.0) -> Box:
        a, b = to_floats(self.a), to_floats(self.b)
        return bound_points(a, b, margin=to_floats(self.radius) + level)


@dataclass(frozen=True, eq=False, repr=False)
class capped_cylinder(Rod):
    """A cylinder with flat ends.

    Parameters
    ----------
    a, b : three numbers, default (0, 0, -0.5) and (0, 0, 0.5)
        The centres of the ends.
    radius : number > 0, default 0.5
        The radius of the cylinder.
    """

    radius: Any = number(0.5, above=0)

    def distance(self, p: JitVector) -> JitFloat:
        t, x, squared = self._project_onto_segment(p)
        x = x - self.radius
        y = (absolute(t - 0.5) - 0.5) * squared**0.5
        return length(maximum(x, 0.0), maximum(y, 0.0)) + minimum(maximum(x, y), 0.0)

    def bounds(self, level: float = 0.0) -> Box:
        return self._bound_discs(self.radius, self.radius, level)


@dataclass(frozen=True, eq=False, repr=False)
class capped_cone(Rod):
    """A cone, or a truncated cone, with flat ends.

    Parameters
    ----------
    a, b : three numbers, default (0, 0, -0.5) and (0, 0, 0.5)
        The centres of the ends.
    radius_a, radius_b : number ≥ 0, default 0.5 and 0
        The radii of the ends; at most one of them is 0.
    """

    radius_a: Any = number(0.5, least=0)
    radius_b: Any = number(0.0, least=0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if to_floats(self.radius_a) == to_floats(self.radius_b) == 0:
            raise BrdfkitError(
                "capped_cone: both radii are 0; for a segment use capsule, radius 0."
            )

    def distance(self, p: JitVector) -> JitFloat:
        t, x, squared = self._project_onto_segment(p)
        height, widening = squared**0.5, self.radius_b - self.radius_a
        # The distances to the disc at the nearer end, across and along the axis
        end_x = maximum(select(t < 0.5, x - self.radius_a, x - self.radius_b), 0.0)
        end_y = (absolute(t - 0.5) - 0.5) * height
        # The nearest point of the side, as a share of the way from a to b, and the distances to it
        share = (widening * (x - self.radius_a) + t * squared) / (widening * widening + squared)
        share = clip(share, 0.0, 1.0)
        side_x = x - self.radius_a - share * widening
        side_y = (t - share) * height
        nearest = minimum(length(end_x, end_y), length(side_x, side_y))
        inside = (side_x < 0.0) & (end_y < 0.0)
        return select(inside, -nearest, nearest)

    def bounds(self, level: float = 0.0) -> Box:
        return self._bound_discs(self.radius_a, self.radius_b, level)
