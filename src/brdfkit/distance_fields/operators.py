"""The operators of distance fields, named as in fogleman's `sdf`."""

from typing import Any, NamedTuple

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.parameters import kind


class Operators:
    """What combines and changes distance fields: ``sphere(1) | box(2).translate((1, 0, 0))``.

    `|` is the union, `&` the intersection, `-` the difference; `a | b.k(0.1)` blends smoothly.
    """

    def __or__(self, other):
        return _combined("union", self, other)

    def __and__(self, other):
        return _combined("intersection", self, other)

    def __sub__(self, other):
        return _combined("difference", self, other)

    def k(self, k: Any) -> "Smooth":
        """This field as the right side of an operator, which blends it in over a width `k`."""
        return Smooth(self, k)

    def translate(self, offset: Any) -> Any:
        """Move by the vector `offset`."""
        return kind("translate")(self, offset)

    def at(self, x: Any, y: Any = None, z: Any = None) -> Any:
        """Move by (x, y, z), given as three numbers or as one triple: as `translate`."""
        if (y is None) != (z is None):
            raise BrdfkitError("at() needs three numbers, or one triple.")
        return self.translate(x if y is None else (x, y, z))

    def rotate(self, angle: Any, axis: Any = (0.0, 0.0, 1.0)) -> Any:
        """Turn by `angle` [rad] about `axis`, through the origin, by the right-hand rule."""
        return kind("rotate")(self, angle, axis)

    def scale(self, factor: Any) -> Any:
        """Scale about the origin by a number above 0, equally in all directions."""
        return kind("scale")(self, factor)

    def dilate(self, distance: Any) -> Any:
        """Grow by `distance` on all sides; shrink where it is negative."""
        return kind("dilate")(self, distance)

    def shell(self, thickness: Any) -> Any:
        """A hollow shell of this thickness, whose middle is the surface."""
        return kind("shell")(self, thickness)

    def made_of(self, material: str) -> Any:
        """Name the material, by which a renderer finds its BSDF."""
        return kind("made_of")(self, material)

    def repeat(self, spacing: Any, copies: int | None = None) -> Any:
        """Repeat at distances `spacing`, 0 along an axis for once.

        There are so many `copies` on each side of the first, or endless ones.
        """
        return kind("repeat")(self, spacing, copies)

    def circular_array(self, copies: int, offset: Any = 0.0) -> Any:
        """So many `copies` around the z axis, after a move by `offset` along x."""
        return kind("circular_array")(self.at(offset, 0, 0) if offset else self, copies)


class Smooth(NamedTuple):
    """A field that the next operator blends in over the width `k`."""

    field: Any
    k: Any

    def __ror__(self, other):
        return kind("union")((other, self.field), self.k)

    def __rand__(self, other):
        return kind("intersection")((other, self.field), self.k)

    def __rsub__(self, other):
        return kind("difference")((other, self.field), self.k)


def _combined(name, a, b):
    """A sharp combination; one of several of a kind is one node, as a | b | c."""
    if isinstance(b, Smooth):
        return NotImplemented
    first = a.children if a.kind == name and a.is_sharp else (a,)
    return kind(name)((*first, b))
