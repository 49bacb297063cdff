"""Divides a shadow map into square cells, each with a map of its own, and so its own texel size."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import IntArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.projection import Projection

GUTTER = 4  # texels by which a cell's map is wider on each side, as filters read neighbours


@dataclass(frozen=True)
class Cell:
    """The projection of a shadow map that covers only a square, a cell, of a larger map.

    whole : the projection of the larger map.
    x, y : coordinates of the cell's centre on the larger map, in [-1, 1].
    half : half the side of the cell; the larger map has the side 2.
    """

    whole: Projection
    x: Any
    y: Any
    half: Any

    @classmethod
    def from_grid(
        cls, whole: Projection, column: int, row: int, cells: int, resolution: int
    ) -> "Cell":
        """Return one of `cells` × `cells` equal cells of a map, `GUTTER` texels wider on each side.

        whole : the projection of the map.
        column, row : indices of the cell in the grid, counted from the corner (-1, -1).
        resolution : number of texels along a side of the cell's own map.
        """
        x, y = ((2 * place + 1) / cells - 1 for place in (column, row))
        return cls(whole, x, y, resolution / (resolution - 2 * GUTTER) / cells)

    @property
    def light(self) -> Light:
        """The light that casts the shadows of the map."""
        return self.whole.light

    def make_opaque(self) -> "Cell":
        """Return a copy with opaque Dr.Jit numbers, so that all cells share one compiled kernel."""
        import mitsuba as mi

        numbers = {name: dr.opaque(mi.Float, getattr(self, name)) for name in ("x", "y", "half")}
        return replace(self, whole=self.whole.make_opaque(), **numbers)

    def project(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return the coordinates, in [-1, 1] on the cell's map, and the depth of a world point."""
        u, v, depth = self.whole.project(x, y, z)
        return (u - self.x) / self.half, (v - self.y) / self.half, depth

    def is_projectable(self, x: JitFloat, y: JitFloat, z: JitFloat) -> JitMask:
        """Return whether the projection can map a point at all: its homogeneous w is above 0."""
        return self.whole.is_projectable(x, y, z)

    def directional_derivative(self, point: JitVector, way: JitVector) -> tuple[JitFloat, ...]:
        """Return the derivatives of map coordinates and depth as a point moves along `way`."""
        u, v, depth = self.whole.directional_derivative(point, way)
        return u / self.half, v / self.half, depth

    def direction_to_light(self, p: JitVector) -> JitVector:
        """Return the unit vectors from the points `p` to the light."""
        return self.whole.direction_to_light(p)

    def light_ray(self, x: JitFloat, y: JitFloat) -> tuple[Any, Any]:
        """Return origin and unit direction of the light ray through (x, y) of the cell's map."""
        return self.whole.light_ray(x * self.half + self.x, y * self.half + self.y)

    def unproject(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return the world point with the coordinates x and y on the cell's map and the depth z."""
        return self.whole.unproject(x * self.half + self.x, y * self.half + self.y, z)


def make_cell_finder(whole: Projection, table: IntArray) -> Callable[[JitVector], JitInt]:
    """Return a function that finds the index of the cell in which a point of the world lies.

    whole : projection of the map that is divided into cells.
    table : a regular grid (n, n) over that map, [row, column], with the index of the cell to which
        each square of the grid belongs.
    """
    import mitsuba as mi

    opaque, entries = whole.make_opaque(), mi.UInt32(np.ravel(table).astype(np.uint32))
    dr.make_opaque(entries)
    count = dr.opaque(mi.Float, float(len(table)))

    def find_grid_index(place: JitFloat) -> JitInt:
        return mi.UInt32(dr.clip(dr.floor((place + 1) / 2 * count), 0, count - 1))

    def find_cell(p: JitVector) -> JitInt:
        column, row = (find_grid_index(place) for place in opaque.project(*p)[:2])
        return dr.gather(mi.UInt32, entries, row * mi.UInt32(count) + column)

    return find_cell
