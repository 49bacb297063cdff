"""The operators of distance fields, named as in M. Fogleman's package `sdf`."""

from typing import Any, NamedTuple

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.parameters import find_kind


class Operators:
    """Operators and methods that combine, move and change distance fields.

    `|` is the union, `&` the intersection, `-` the difference; `a | b.k(0.1)` blends smoothly:
    ``sphere(1) | box(2).translate((1, 0, 0))``.
    """

    def __or__(self, other: Any) -> Any:
        return _combine("union", self, other)

    def __and__(self, other: Any) -> Any:
        return _combine("intersection", self, other)

    def __sub__(self, other: Any) -> Any:
        return _combine("difference", self, other)

    def k(self, k: Any) -> "Smooth":
        """Return this field as an operand that is blended over a width: ``a | b.k(0.1)``."""
        return Smooth(self, k)

    def translate(self, offset: Any) -> Any:
        """Move by the vector `offset`."""
        return find_kind("translate")(self, offset)

    def at(self, x: Any, y: Any = None, z: Any = None) -> Any:
        """Move by (x, y, z), given as three numbers or as one triple, as `translate` does."""
        if (y is None) != (z is None):
            raise BrdfkitError("at() needs three numbers, or one triple.")
        return self.translate(x if y is None else (x, y, z))

    def rotate(self, angle: Any, axis: Any = (0.0, 0.0, 1.0)) -> Any:
        """Turn by `angle` [rad] about `axis`, through the origin, by the right-hand rule."""
        return find_kind("rotate")(self, angle, axis)

    def scale(self, factor: Any) -> Any:
        """Scale about the origin by a number above 0, equally in all directions."""
        return find_kind("scale")(self, factor)

    def dilate(self, distance: Any) -> Any:
        """Grow by `distance` on all sides; a negative distance shrinks."""
        return find_kind("dilate")(self, distance)

    def shell(self, thickness: Any) -> Any:
        """Make a hollow shell of this thickness, with the surface in its middle."""
        return find_kind("shell")(self, thickness)

    def made_of(self, material: str) -> Any:
        """Name the material, which a renderer uses to find the BSDF."""
        return find_kind("made_of")(self, material)

    def repeat(self, spacing: Any, copies: int | None = None) -> Any:
        """Repeat in a lattice with distances `spacing`; 0 along an axis does not repeat there.

        There are `copies` copies on each side of the first one, or without end if it is None.
        """
        return find_kind("repeat")(self, spacing, copies)

    def circular_array(self, copies: int, offset: Any = 0.0) -> Any:
        """Arrange `copies` copies around the z axis, after a move by `offset` along x."""
        return find_kind("circular_array")(self.at(offset, 0, 0) if offset else self, copies)


class Smooth(NamedTuple):
    """A field that the next operator blends in over the width `k`."""

    field: Any
    k: Any

    def __ror__(self, other: Any) -> Any:
        return find_kind("union")((other, self.field), self.k)

    def __rand__(self, other: Any) -> Any:
        return find_kind("intersection")((other, self.field), self.k)

    def __rsub__(self, other: Any) -> Any:
        return find_kind("difference")((other, self.field), self.k)


def _combine(name: str, a: Any, b: Any) -> Any:
    """Combine two fields sharply; a chain such as a | b | c becomes one node."""
    if isinstance(b, Smooth):
        return NotImplemented
    first = a.children if a.kind == name and a.is_sharp else (a,)
    return find_kind(name)((*first, b))
