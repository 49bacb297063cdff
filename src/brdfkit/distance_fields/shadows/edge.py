"""`edge`: which rays to the light an occluder lets through, without any further distance.

The occluder of a `Shadow` ends at a straight line on the disc, across the gradient of the distance.
So samples of a light, of a sphere or of any shape within it, are visible or not by arithmetic.

[Bálint et al. 2019, sections 5.2, 5.3]
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.distance_fields.shadows.field import distance_of

STEP = 0.02  # of the differences, over the radius of the section


@dataclass(frozen=True)
class Edge:
    """Light comes through at (x, y) of the disc where x n_x + y n_y ≥ -offset.

    n_x, n_y : Float, a unit vector that points away from the occluder.
    offset : Float, how far the line is from the centre; negative where the centre is in shadow.
    """

    n_x: Any
    n_y: Any
    offset: Any

    def lets_through(self, x, y):
        """Whether the ray at (x, y) of the unit disc reaches the light."""
        return x * self.n_x + y * self.n_y >= -self.offset

    def shows(self, cone, point):
        """Whether a `point` of the light, or of a shape within its sphere, is seen."""
        return self.lets_through(*cone.disc(point))


def edge(field, cone, shadow):
    """The `Edge` of the occluder of a `Shadow` in this `cone`.

    The plane that touches the occluder goes through the apex, and is not parallel to the axis: its
    line is r / √(1 - r² tan² α) from the centre.
    """
    middle = distance_of(field)(cone.point(shadow.t))
    x, y = gradient_across(field, cone, shadow.t, middle)
    length = dr.sqrt(x * x + y * y)
    flat = length == 0  # nothing leans to any side
    length = dr.select(flat, 1, length)
    lean = dr.safe_sqrt(1 - dr.square(shadow.r * cone.tan))
    offset = dr.select(shadow.r < 1, shadow.r / dr.maximum(lean, 1e-3), 1)
    return Edge(dr.select(flat, 1, x / length), y / length, offset)


def gradient_across(field, cone, t, middle):
    """The gradient's components along the two directions of the section at t, by differences.

    `middle` is the distance on the axis.
    """
    f, width = distance_of(field), STEP * cone.radius(t)
    aside = f(cone.across(t, STEP, 0)), f(cone.across(t, 0, STEP))
    return tuple((there - middle) / width for there in aside)
