"""The operators of distance fields, named as in M. Fogleman's package `sdf`."""

from typing import Any, NamedTuple

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.parameters import find_node_class


class Operators:
    """Operators and methods that combine, move and change distance fields.

    `|` is the union, `&` the intersection, `-` the difference; `a | b.k(0.1)` blends smoothly:
    ``sphere(1) | box(2).translate((1, 0, 0))``.
    """

    def __or__(self, other: Any) -> Any:
        return _combine_sharply("union", self, other)

    def __and__(self, other: Any) -> Any:
        return _combine_sharply("intersection", self, other)

    def __sub__(self, other: Any) -> Any:
        return _combine_sharply("difference", self, other)

    def k(self, k: Any) -> "Smooth":
        """Return this field as an operand that is blended over a width `k`: ``a | b.k(0.1)``."""
        return Smooth(self, k)

    def translate(self, offset: Any) -> Any:
        """Return the solid moved by the vector `offset`."""
        return find_node_class("translate")(self, offset)

    def at(self, x: Any, y: Any = None, z: Any = None) -> Any:
        """Return the solid moved by (x, y, z), given as three numbers or as one triple."""
        if (y is None) != (z is None):
            raise BrdfkitError("at() needs three numbers, or one triple.")
        return self.translate(x if y is None else (x, y, z))

    def rotate(self, angle: Any, axis: Any = (0.0, 0.0, 1.0)) -> Any:
        """Return the solid turned by `angle` [rad] about `axis`, a line through the origin."""
        return find_node_class("rotate")(self, angle, axis)

    def scale(self, factor: Any) -> Any:
        """Return the solid scaled about the origin by a number above 0, in all directions."""
        return find_node_class("scale")(self, factor)

    def dilate(self, distance: Any) -> Any:
        """Return the solid grown by `distance` on all sides; a negative distance shrinks it."""
        return find_node_class("dilate")(self, distance)

    def shell(self, thickness: Any) -> Any:
        """Return a hollow shell of this thickness, with the solid's surface in its middle."""
        return find_node_class("shell")(self, thickness)

    def made_of(self, material: str) -> Any:
        """Return the solid with the name of its material, by which a renderer finds the BSDF."""
        return find_node_class("made_of")(self, material)

    def repeat(self, spacing: Any, copies: int | None = None) -> Any:
        """Return copies of the solid in a lattice with distances `spacing` along x, y and z.

        Along an axis with spacing 0 there is only the solid itself. Along the others there are
        `copies` copies on each side of it, or infinitely many for None.
        """
        return find_node_class("repeat")(self, spacing, copies)

    def circular_array(self, copies: int, offset: Any = 0.0) -> Any:
        """Return `copies` copies of the solid around the z axis, moved along x by `offset`."""
        return find_node_class("circular_array")(self.at(offset, 0, 0) if offset else self, copies)


class Smooth(NamedTuple):
    """A field that the next operator combines with another by a smooth blend of the width `k`."""

    field: Any
    k: Any

    def __ror__(self, other: Any) -> Any:
        return find_node_class("union")((other, self.field), self.k)

    def __rand__(self, other: Any) -> Any:
        return find_node_class("intersection")((other, self.field), self.k)

    def __rsub__(self, other: Any) -> Any:
        return find_node_class("difference")((other, self.field), self.k)


def _combine_sharply(name: str, a: Any, b: Any) -> Any:
    """Return the sharp combination of two fields; a chain such as a | b | c becomes one node.

    name : kind of the combination: union, intersection or difference.
    """
    if isinstance(b, Smooth):
        return NotImplemented
    first = a.children if a.kind == name and a.is_sharp else (a,)
    return find_node_class(name)((*first, b))
