"""Union, intersection and difference, sharp or blended smoothly.

Of sharp ones the distance is min(f, g), max(f, g), max(f, -g) [Bálint et al. 2019, theorem 1]. A
smooth minimum is min(f, g) - b/4 max(1 - |f - g|/b, 0)², a polynomial, blended over a width b; its
slope is between those of f and g, so that it has their bound L. It is an estimate on both sides.
"""

from dataclasses import dataclass
from functools import reduce
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import join, overlap, plain
from brdfkit.distance_fields.functions import absolute, maximum, minimum
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import number


@dataclass(frozen=True, eq=False, repr=False)
class Combination(Node):
    """Several solids made one, blended over the width `blend`.

    Parameters
    ----------
    children : tuple of distance fields
        At least one.
    blend : number ≥ 0, default 0
        The width over which they are blended; 0 for a sharp edge.
    """

    children: tuple[Node, ...] = ()
    blend: Any = number(0.0, least=0)

    def __post_init__(self):
        if isinstance(self.children, Node):
            raise BrdfkitError(f"{self.kind}: give the fields as one list, [a, b].")
        object.__setattr__(self, "children", tuple(self.children))
        if not self.children:
            raise BrdfkitError(f"{self.kind}: there is nothing in it; give at least one field.")
        super().__post_init__()

    @property
    def is_sharp(self) -> bool:
        """True where nothing is blended."""
        return isinstance(self.blend, float) and self.blend == 0

    def all_are(self, quality):
        """True if all children have a quality, and nothing is blended."""
        return self.is_sharp and all(getattr(child, quality) for child in self.children)

    def smallest(self, f, g):
        """The minimum of two distances, smooth over the width `blend`."""
        if self.is_sharp:
            return minimum(f, g)
        near = maximum(1.0 - absolute(f - g) / self.blend, 0.0)
        return minimum(f, g) - 0.25 * self.blend * near * near

    def largest(self, f, g):
        """The maximum of two distances, smooth over the width `blend`."""
        return maximum(f, g) if self.is_sharp else -self.smallest(-f, -g)


@dataclass(frozen=True, eq=False, repr=False)
class union(Combination):
    """All points of any of the children.

    Parameters
    ----------
    children : tuple of distance fields
        At least one.
    blend : number ≥ 0, default 0
        The width over which they are blended; 0 for a sharp edge.
    """

    @property
    def exact_outside(self):
        return self.all_are("exact_outside")

    def distance(self, p):
        return reduce(self.smallest, [child.distance(p) for child in self.children])

    def bounds(self, level=0.0):
        level = level + 0.25 * plain(self.blend) * (len(self.children) - 1)
        return join([child.bounds(level) for child in self.children])


@dataclass(frozen=True, eq=False, repr=False)
class intersection(Combination):
    """The points that all of the children have in common.

    Parameters
    ----------
    children : tuple of distance fields
        At least one.
    blend : number ≥ 0, default 0
        The width over which they are blended; 0 for a sharp edge.
    """

    @property
    def exact_inside(self):
        return self.all_are("exact_inside")

    @property
    def is_convex(self):
        return all(child.is_convex for child in self.children)

    def distance(self, p):
        return reduce(self.largest, [child.distance(p) for child in self.children])

    def bounds(self, level=0.0):
        return overlap([child.bounds(level) for child in self.children])


@dataclass(frozen=True, eq=False, repr=False)
class difference(Combination):
    """The points of the first child that are in none of the others.

    Parameters
    ----------
    children : tuple of distance fields
        At least one.
    blend : number ≥ 0, default 0
        The width over which they are blended; 0 for a sharp edge.
    """

    @property
    def exact_inside(self):
        first, *others = self.children
        return self.is_sharp and first.exact_inside and all(c.exact_outside for c in others)

    def distance(self, p):
        first, *others = [child.distance(p) for child in self.children]
        return reduce(self.largest, [-other for other in others], first)

    def bounds(self, level=0.0):
        return self.children[0].bounds(level)
