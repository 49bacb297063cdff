"""Square cells of a shadow map, each with a map of its own, in finer or coarser texels."""

from dataclasses import dataclass, replace
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.shadows.maps.projection import Projection

GUTTER = 4  # texels beyond the edge of a cell that its map has too, for filters


@dataclass(frozen=True)
class Cell:
    """The projection by which a square of another one's map fills the map.

    whole : the `Projection` of the other map.
    x, y : the middle of the square there.
    half : half of its side.
    """

    whole: Projection
    x: Any
    y: Any
    half: Any

    @classmethod
    def of_grid(cls, whole, column, row, cells, resolution):
        """The cell of a grid of `cells` × `cells`, with room for a gutter at this `resolution`."""
        x, y = ((2 * place + 1) / cells - 1 for place in (column, row))
        return cls(whole, x, y, resolution / (resolution - 2 * GUTTER) / cells)

    @property
    def light(self):
        return self.whole.light

    def opaque(self):
        """The same for Dr.Jit."""
        import mitsuba as mi

        numbers = {name: dr.opaque(mi.Float, getattr(self, name)) for name in ("x", "y", "half")}
        return replace(self, whole=self.whole.opaque(), **numbers)

    def to_map(self, x, y, z):
        """Where a point of the world is in the cube."""
        u, v, depth = self.whole.to_map(x, y, z)
        return (u - self.x) / self.half, (v - self.y) / self.half, depth

    def is_before(self, x, y, z):
        """Whether the projection maps a point at all."""
        return self.whole.is_before(x, y, z)

    def along(self, point, way):
        """The derivative of `to_map` at a `point` along a `way`, both of three components."""
        u, v, depth = self.whole.along(point, way)
        return u / self.half, v / self.half, depth

    def to_light(self, p):
        """The unit vectors from points `p` to the light."""
        return self.whole.to_light(p)

    def ray(self, x, y):
        """The ray of light at a place of the map: its origin and its unit direction."""
        return self.whole.ray(x * self.half + self.x, y * self.half + self.y)

    def from_map(self, x, y, z):
        """The point of the world at a place in the cube."""
        return self.whole.from_map(x * self.half + self.x, y * self.half + self.y, z)


def by_cell(whole, table):
    """The function from points to the numbers in a `table` (n, n) of their cells of the map of
    `whole`, by rows and columns."""
    import mitsuba as mi

    cells = len(table)
    opaque, numbers = whole.opaque(), mi.UInt32(np.ravel(table).astype(np.uint32))
    dr.make_opaque(numbers)
    count = dr.opaque(mi.Float, float(cells))

    def number(place):
        return mi.UInt32(dr.clip(dr.floor((place + 1) / 2 * count), 0, count - 1))

    def which(p):
        x, y, _ = opaque.to_map(*p)
        return dr.gather(mi.UInt32, numbers, number(y) * mi.UInt32(count) + number(x))

    return which
