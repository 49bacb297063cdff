"""Solids around the origin: plane, sphere, box, rounded box, torus. Their distances are exact.

[Bálint et al. 2019, chapter 2]
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import Box, bound_points, to_floats
from brdfkit.distance_fields.functions import absolute, dot, length, maximum, minimum, normalize
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import number, vector


class Exact(Node):
    """The base of solids whose field is the exact distance, inside and outside."""

    exact_outside = exact_inside = True


@dataclass(frozen=True, eq=False, repr=False)
class plane(Exact):
    """The half-space below a plane through the origin.

    Parameters
    ----------
    normal : three numbers, default (0, 0, 1)
        A vector of any length that points out of the half-space.
    """

    normal: Any = vector((0.0, 0.0, 1.0))
    is_convex = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if not np.any(to_floats(self.normal)):
            raise BrdfkitError("plane.normal = (0, 0, 0) has no direction; give another normal.")

    def distance(self, p: JitVector) -> JitFloat:
        return dot((p.x, p.y, p.z), normalize(self.normal))


@dataclass(frozen=True, eq=False, repr=False)
class sphere(Exact):
    """A ball around the origin.

    Parameters
    ----------
    radius : number > 0, default 1
        The radius of the ball.
    """

    radius: Any = number(1.0, above=0)
    is_convex = True

    def distance(self, p: JitVector) -> JitFloat:
        return length(p.x, p.y, p.z) - self.radius

    def bounds(self, level: float = 0.0) -> Box:
        return bound_points(np.zeros(3), margin=to_floats(self.radius) + level)


@dataclass(frozen=True, eq=False, repr=False)
class box(Exact):
    """A box around the origin, along the axes.

    Parameters
    ----------
    size : three numbers > 0, or one for a cube, default 1
        The lengths of its edges.
    """

    size: Any = vector((1.0, 1.0, 1.0), above=0, spread=True)
    is_convex = True

    def distance(self, p: JitVector) -> JitFloat:
        return box_distance(p, self.size)

    def bounds(self, level: float = 0.0) -> Box:
        half = to_floats(self.size) / 2
        return bound_points(half, -half, margin=level)


@dataclass(frozen=True, eq=False, repr=False)
class rounded_box(box):
    """A box around the origin, along the axes, whose edges are round.

    Parameters
    ----------
    size : three numbers > 0, or one for a cube, default 1
        The lengths of its edges.
    radius : number ≥ 0, default 0.1
        The radius of the edges, at most half of the shortest edge's length.
    """

    radius: Any = number(0.1, least=0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if 2 * to_floats(self.radius) > min(to_floats(self.size)):
            raise BrdfkitError(
                f"rounded_box.radius = {to_floats(self.radius):g} should be at most half of the "
                f"shortest edge, {min(to_floats(self.size)) / 2:g}."
            )

    def distance(self, p: JitVector) -> JitFloat:
        inner = [edge - 2 * self.radius for edge in self.size]
        return box_distance(p, inner) - self.radius


@dataclass(frozen=True, eq=False, repr=False)
class torus(Exact):
    """A ring around the z axis.

    Parameters
    ----------
    radius : number > 0, default 1
        The distance from the origin to the middle of the tube.
    tube : number > 0, default 0.25
        The radius of the tube.
    """

    radius: Any = number(1.0, above=0)
    tube: Any = number(0.25, above=0)

    def distance(self, p: JitVector) -> JitFloat:
        return length(length(p.x, p.y) - self.radius, p.z) - self.tube

    def bounds(self, level: float = 0.0) -> Box:
        tube = to_floats(self.tube) + level
        outer = to_floats(self.radius) + tube
        corner = np.array([outer, outer, tube])
        return -corner, corner


def box_distance(p: JitVector, size: Iterable[JitFloat]) -> JitFloat:
    """Return the distance from `p` to a box around the origin with edges of the lengths `size`.

    It is ‖max(q, 0)‖ + min(max(qx, qy, qz), 0) with q = |p| - size/2.
    """
    x, y, z = (absolute(c) - 0.5 * edge for c, edge in zip((p.x, p.y, p.z), size, strict=True))
    outside = length(maximum(x, 0.0), maximum(y, 0.0), maximum(z, 0.0))
    return outside + minimum(maximum(x, maximum(y, z)), 0.0)
