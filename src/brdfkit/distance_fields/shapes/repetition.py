"""Repetition of a solid in a lattice, where only the copy in the cell of a point is evaluated.

Let g be the distance to this copy. All other copies lie beyond the cell's faces, with a gap between
face and copy. So a step to a face plus half of the gap is safe. The other half is taken up by a box
around each copy; g is limited from below by the distance b to that box, which makes f continuous
where cells meet:

    f = max(min(max(g, b), min_faces(e + gap/2)), B)

Here e is the distance to a face, and min_faces the minimum over the faces beyond which there is a
copy. B is the distance to the box of the whole lattice, which makes steps outside of it long.

f is an estimate whose error is at most about the size of a cell. Its sign is right, and its bound L
is the child's. Its derivatives with respect to the child's parameters are right near the surface,
where f equals g; gaps and boxes have none.
"""

from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import Box, to_floats
from brdfkit.distance_fields.functions import Point, absolute, clip, floor, maximum, minimum, select
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import count, vector


@dataclass(frozen=True, eq=False, repr=False)
class repeat(Node):
    """A solid repeated in a lattice along the axes.

    Parameters
    ----------
    child : distance field
        The solid, which lies within the cell around the origin and does not touch its faces.
    spacing : three numbers ≥ 0, or one for all, default 1
        Distances between the copies along x, y and z; 0 along an axis with a single copy.
    copies : integer, optional
        The number of copies on each side of the first; without it the lattice is infinite.
    """

    child: Node
    spacing: Any = vector((1.0, 1.0, 1.0), least=0, spread=True)
    copies: int | None = count(None, optional=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        low, high = self.child.bounds()
        for axis in self.repeated_axes:
            size = to_floats(self.spacing)[axis]
            if max(-low[axis], high[axis]) >= size / 2:
                raise BrdfkitError(
                    f"repeat: the field reaches from {low[axis]:g} to {high[axis]:g} along "
                    f"{'xyz'[axis]}, but a cell only from {-size / 2:g} to {size / 2:g}; give a "
                    "larger spacing, or move or scale the field."
                )

    @property
    def repeated_axes(self) -> list[int]:
        """The axes (0 to 2) along which there are several copies."""
        return [i for i in range(3) if to_floats(self.spacing)[i] > 0 and self.copies != 0]

    @property
    def lipschitz(self) -> float:
        """An upper bound on the slope: the child's, but at least 1, the slope of a box's field."""
        return max(self.child.lipschitz, 1.0)

    def distance(self, p: JitVector) -> JitFloat:
        if not self.repeated_axes:
            return self.child.distance(p)
        # Python's numbers, as NumPy's would make all values double precision
        low, high = (corner.tolist() for corner in self._box_with_half_gaps())
        reach, gaps = self._lattice_reach().tolist(), self._cell_gaps().tolist()
        local, boxes, faces, lattice = [p.x, p.y, p.z], [], [], []
        for i, x in enumerate(local):
            if not np.isfinite(high[i] - low[i]):
                continue
            centre, half = 0.5 * (low[i] + high[i]), 0.5 * (high[i] - low[i])
            if np.isfinite(reach[i]):
                lattice.append(absolute(x - centre) - (half + reach[i]))
            if i in self.repeated_axes:
                cell = floor(x / self.spacing[i] + 0.5)
                if self.copies is not None:
                    cell = clip(cell, -float(self.copies), float(self.copies))
                local[i] = x - self.spacing[i] * cell
                boxes.append(absolute(local[i] - centre) - half)
                safe = 0.5 * (self.spacing[i] + gaps[i])
                faces.append(self._face_distance(cell, 1, safe - local[i]))
                faces.append(self._face_distance(cell, -1, safe + local[i]))
        own = reduce(maximum, boxes, self.child.distance(Point(*local)))
        return reduce(maximum, lattice, reduce(minimum, faces, own))

    def bounds(self, level: float = 0.0) -> Box:
        low, high = self.child.bounds(level)
        if level > 0 and self.repeated_axes:  # between the copies f may be below `level`, too
            low, high = self._box_with_half_gaps()
            low, high = low - level, high + level
        return low - self._lattice_reach(), high + self._lattice_reach()

    def _lattice_reach(self) -> FloatArray:
        """Return the distances (3,) from the first copy to the outermost ones along each axis."""
        copies = np.inf if self.copies is None else self.copies
        return np.array([copies * s if s > 0 else 0.0 for s in to_floats(self.spacing)])

    def _cell_gaps(self) -> FloatArray:
        """Return the gaps (3,) between the child and its cell's faces along each axis.

        For an axis without repetition, it is the largest gap of the other axes.
        """
        low, high = self.child.bounds()
        gaps = to_floats(self.spacing) / 2 - np.maximum(-low, high)
        axes = self.repeated_axes
        return np.array([gaps[i if i in axes else axes].max() for i in range(3)])

    def _box_with_half_gaps(self) -> Box:
        """Return the box of the child, grown by half of the gap on each side."""
        low, high = self.child.bounds()
        return low - self._cell_gaps() / 2, high + self._cell_gaps() / 2

    def _face_distance(self, cell: JitFloat, side: int, distance: JitFloat) -> JitFloat:
        """Return the `distance` to a face of a cell, or 1e30 where no copy lies beyond the face."""
        if self.copies is None:
            return distance
        return select(side * cell < self.copies - 0.5, distance, 1e30)
