"""Tells which points of a light are visible, from a single march along a cone to the light.

The march gives a `Shadow`: how much of the light an occluder hides. The model behind it is that the
occluder's edge, seen from the surface point, is a straight line across the cone's circular section.
The line is at right angles to the gradient of the distance field. So simple arithmetic tells on
which side of the edge a point of the light lies, without further evaluations of the distance. The
light is a sphere, or any shape within it.

[Bálint et al. 2019, sections 5.2, 5.3]
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, JitVector
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.field import distance_function
from brdfkit.distance_fields.shadows.shadow import Shadow

STEP = 0.02  # step of the finite differences, as a share of the section's radius


@dataclass(frozen=True)
class Edge:
    """A line on the unit disc: light comes through at (x, y) where x n_x + y n_y ≥ -offset.

    n_x, n_y : Float, a unit vector that points away from the occluder.
    offset : Float, the distance of the line from the centre; negative where the centre is dark.
    """

    n_x: Any
    n_y: Any
    offset: Any

    def is_lit_at(self, x: JitFloat, y: JitFloat) -> JitMask:
        """Return whether the ray at (x, y) of the unit disc reaches the light."""
        return x * self.n_x + y * self.n_y >= -self.offset

    def is_point_visible(self, cone: LightCone, point: JitVector) -> JitMask:
        """Return whether a `point` of the light, or of a shape within its sphere, is visible."""
        return self.is_lit_at(*cone.project_to_disc(point))


def find_edge(field: Any, cone: LightCone, shadow: Shadow) -> Edge:
    """Return the straight edge of the occluder that a march in `cone` found.

    The plane that touches the occluder goes through the cone's apex, and cuts the disc in a line.
    With the smallest ratio r of distance to cone radius, and the cone's half angle α, the line is
    r / √(1 - r² tan² α) from the disc's centre.

    shadow : result of the march.
    """
    on_axis = distance_function(field)(cone.point(shadow.t))
    x, y = gradient_across_axis(field, cone, shadow.t, on_axis)
    length = dr.sqrt(x * x + y * y)
    flat = length == 0  # the distance changes only along the axis, so that any direction will do
    length = dr.select(flat, 1, length)
    lean = dr.safe_sqrt(1 - dr.square(shadow.r * cone.tan))
    offset = dr.select(shadow.r < 1, shadow.r / dr.maximum(lean, 1e-3), 1)
    return Edge(dr.select(flat, 1, x / length), y / length, offset)


def gradient_across_axis(
    field: Any, cone: LightCone, t: JitFloat, on_axis: JitFloat
) -> tuple[JitFloat, ...]:
    """Return the gradient of a field within the cone's section at t, by finite differences.

    Its two components are along the cone's `basis`.

    on_axis : the distance at the point of the axis.
    """
    f, width = distance_function(field), STEP * cone.radius(t)
    aside = f(cone.disc_point(t, STEP, 0)), f(cone.disc_point(t, 0, STEP))
    return tuple((there - on_axis) / width for there in aside)
