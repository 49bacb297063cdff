"""Square cells of a shadow map, each with a map of its own whose texels are finer or coarser."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import IntArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.projection import Projection

GUTTER = 4  # texels that a cell's map has beyond the cell's edge, for filters


@dataclass(frozen=True)
class Cell:
    """The projection that lets a square of another projection's map fill a whole map.

    whole : the other projection.
    x, y : the middle of the square on its map.
    half : half of the square's side.
    """

    whole: Projection
    x: Any
    y: Any
    half: Any

    @classmethod
    def from_grid(
        cls, whole: Projection, column: int, row: int, cells: int, resolution: int
    ) -> "Cell":
        """Return a cell of a grid of `cells` × `cells`, with a gutter at this `resolution`."""
        x, y = ((2 * place + 1) / cells - 1 for place in (column, row))
        return cls(whole, x, y, resolution / (resolution - 2 * GUTTER) / cells)

    @property
    def light(self) -> Light:
        """The light of the whole map."""
        return self.whole.light

    def opaque(self) -> "Cell":
        """Return the cell with opaque Dr.Jit numbers, so that one kernel serves all cells."""
        import mitsuba as mi

        numbers = {name: dr.opaque(mi.Float, getattr(self, name)) for name in ("x", "y", "half")}
        return replace(self, whole=self.whole.opaque(), **numbers)

    def to_map(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return where a point of the world is in the map's cube."""
        u, v, depth = self.whole.to_map(x, y, z)
        return (u - self.x) / self.half, (v - self.y) / self.half, depth

    def is_before(self, x: JitFloat, y: JitFloat, z: JitFloat) -> JitMask:
        """Return whether the projection maps a point at all."""
        return self.whole.is_before(x, y, z)

    def derivative_along(self, point: JitVector, way: JitVector) -> tuple[JitFloat, ...]:
        """Return the derivative of `to_map` at a `point` along a vector `way`."""
        u, v, depth = self.whole.derivative_along(point, way)
        return u / self.half, v / self.half, depth

    def to_light(self, p: JitVector) -> JitVector:
        """Return the unit vectors from points `p` to the light."""
        return self.whole.to_light(p)

    def ray(self, x: JitFloat, y: JitFloat) -> tuple[Any, Any]:
        """Return the ray of light at a place of the map: its origin and its unit direction."""
        return self.whole.ray(x * self.half + self.x, y * self.half + self.y)

    def from_map(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return the point of the world at a place in the map's cube."""
        return self.whole.from_map(x * self.half + self.x, y * self.half + self.y, z)


def make_cell_finder(whole: Projection, table: IntArray) -> Callable[[JitVector], JitInt]:
    """Return the function from points to the entries of a `table` (n, n) of cells.

    The table covers the map of `whole`, by rows and columns.
    """
    import mitsuba as mi

    opaque, entries = whole.opaque(), mi.UInt32(np.ravel(table).astype(np.uint32))
    dr.make_opaque(entries)
    count = dr.opaque(mi.Float, float(len(table)))

    def to_index(place: JitFloat) -> JitInt:
        return mi.UInt32(dr.clip(dr.floor((place + 1) / 2 * count), 0, count - 1))

    def part_of(p: JitVector) -> JitInt:
        x, y, _ = opaque.to_map(*p)
        return dr.gather(mi.UInt32, entries, to_index(y) * mi.UInt32(count) + to_index(x))

    return part_of
