"""Union, intersection and difference of solids, sharp or blended smoothly.

Of two solids with the fields f and g, the field of a sharp combination is min(f, g), max(f, g) or
max(f, -g) [Bálint et al. 2019, theorem 1]. The smooth minimum is the polynomial min(f, g) - b/4
max(1 - |f - g|/b, 0)², blended over a width b. Its slope lies between those of f and g, so that
their bound L holds for it. It is an estimate of the distance on both sides of the surface.
"""

from dataclasses import dataclass
from functools import reduce
from typing import Any

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import Box, intersect_boxes, join_boxes, to_floats
from brdfkit.distance_fields.functions import absolute, maximum, minimum
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import number


@dataclass(frozen=True, eq=False, repr=False)
class Combination(Node):
    """The base of nodes that make one solid of several `children`, blended over a width `blend`."""

    children: tuple[Node, ...] = ()
    blend: Any = number(0.0, least=0)

    def __post_init__(self) -> None:
        if isinstance(self.children, Node):
            raise BrdfkitError(f"{self.kind}: give the fields as one list, [a, b].")
        object.__setattr__(self, "children", tuple(self.children))
        if not self.children:
            raise BrdfkitError(f"{self.kind}: it has no children; give at least one field.")
        super().__post_init__()

    @property
    def is_sharp(self) -> bool:
        """True if the children are combined without a blend."""
        return isinstance(self.blend, float) and self.blend == 0

    def _smooth_minimum(self, f: JitFloat, g: JitFloat) -> JitFloat:
        """Return the minimum of two distances, smooth over the width `blend`."""
        if self.is_sharp:
            return minimum(f, g)
        near = maximum(1.0 - absolute(f - g) / self.blend, 0.0)
        return minimum(f, g) - 0.25 * self.blend * near * near

    def _smooth_maximum(self, f: JitFloat, g: JitFloat) -> JitFloat:
        """Return the maximum of two distances, smooth over the width `blend`."""
        return maximum(f, g) if self.is_sharp else -self._smooth_minimum(-f, -g)


@dataclass(frozen=True, eq=False, repr=False)
class union(Combination):
    """The solid of all points that lie in any of the children.

    Parameters
    ----------
    children : tuple of distance fields
        The solids, at least one.
    blend : number ≥ 0, default 0
        The width over which they are blended; 0 for a sharp edge.
    """

    @property
    def exact_outside(self) -> bool:
        """True if nothing is blended, and the children's fields are exact distances outside."""
        return self.is_sharp and all(child.exact_outside for child in self.children)

    def distance(self, p: JitVector) -> JitFloat:
        return reduce(self._smooth_minimum, [child.distance(p) for child in self.children])

    def bounds(self, level: float = 0.0) -> Box:
        level = level + 0.25 * to_floats(self.blend) * (len(self.children) - 1)
        return join_boxes([child.bounds(level) for child in self.children])


@dataclass(frozen=True, eq=False, repr=False)
class intersection(Combination):
    """The solid of the points that all of the children have in common.

    Parameters
    ----------
    children : tuple of distance fields
        The solids, at least one.
    blend : number ≥ 0, default 0
        The width over which they are blended; 0 for a sharp edge.
    """

    @property
    def exact_inside(self) -> bool:
        """True if nothing is blended, and the children's fields are exact distances inside."""
        return self.is_sharp and all(child.exact_inside for child in self.children)

    @property
    def is_convex(self) -> bool:
        """True if all children are convex."""
        return all(child.is_convex for child in self.children)

    def distance(self, p: JitVector) -> JitFloat:
        return reduce(self._smooth_maximum, [child.distance(p) for child in self.children])

    def bounds(self, level: float = 0.0) -> Box:
        return intersect_boxes([child.bounds(level) for child in self.children])


@dataclass(frozen=True, eq=False, repr=False)
class difference(Combination):
    """The solid of the points that lie in the first child and in none of the others.

    Parameters
    ----------
    children : tuple of distance fields
        The solids, at least one.
    blend : number ≥ 0, default 0
        The width over which they are blended; 0 for a sharp edge.
    """

    @property
    def exact_inside(self) -> bool:
        """True if nothing is blended, and the fields of the children are exact distances.

        This holds inside of the first child, and outside of all others.
        """
        first, *others = self.children
        return self.is_sharp and first.exact_inside and all(c.exact_outside for c in others)

    def distance(self, p: JitVector) -> JitFloat:
        first, *others = [child.distance(p) for child in self.children]
        return reduce(self._smooth_maximum, [-other for other in others], first)

    def bounds(self, level: float = 0.0) -> Box:
        return self.children[0].bounds(level)
