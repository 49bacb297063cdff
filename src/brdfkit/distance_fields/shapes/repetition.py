"""Repetition: copies of a solid in a lattice, of which only the nearest cell's is evaluated.

A cell's own copy has the distance g. All others lie beyond the cell's faces, each by the gap that
its copy leaves there: so far as a point is from a face, plus half of that gap, is safe. To be
continuous where cells meet, g is not less than the distance to a box about the copy, which leaves
the other half:

    f = max(min(max(g, b), min_faces(e + gap/2)), B)

b: distance to the copy's box, e: to a face beyond which there is a copy, B: to the box of the whole
lattice, which makes steps long outside of it. f is an estimate, as far from right as a cell is
large; its sign is right, and L is the child's. Derivatives by the child's parameters are right near
the surface, where g is f; gaps and boxes have none.
"""

from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import plain
from brdfkit.distance_fields.functions import Point, absolute, clip, floor, maximum, minimum, select
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import count, vector


@dataclass(frozen=True, eq=False, repr=False)
class repeat(Node):
    """A solid repeated in a lattice along the axes.

    Parameters
    ----------
    child : distance field
        The solid, within the cell about the origin, and not up to its faces.
    spacing : three numbers ≥ 0, or one for all
        Distances of the copies; 0 along an axis where there is only one.
    copies : integer, optional
        Copies on each side of the first; endless without.
    """

    child: Node
    spacing: Any = vector((1.0, 1.0, 1.0), least=0, spread=True)
    copies: int | None = count(None, optional=True)

    def __post_init__(self):
        super().__post_init__()
        low, high = self.child.bounds()
        for axis in self.repeated:
            size = plain(self.spacing)[axis]
            if max(-low[axis], high[axis]) >= size / 2:
                raise BrdfkitError(
                    f"repeat: the field reaches from {low[axis]:g} to {high[axis]:g} along "
                    f"{'xyz'[axis]}, but a cell only from {-size / 2:g} to {size / 2:g}; give a "
                    "larger spacing, or move or scale the field."
                )

    @property
    def repeated(self) -> list[int]:
        """The axes along which there are several copies."""
        return [i for i in range(3) if plain(self.spacing)[i] > 0 and self.copies != 0]

    @property
    def lipschitz(self):
        return max(self.child.lipschitz, 1.0)

    def distance(self, p):
        if not self.repeated:
            return self.child.distance(p)
        (low, high), reach, gaps = self._roomy_box(), self._reach().tolist(), self._gaps().tolist()
        low, high = low.tolist(), high.tolist()  # NumPy's numbers would make all double precision
        local, boxes, faces, lattice = [p.x, p.y, p.z], [], [], []
        for i, x in enumerate(local):
            if not np.isfinite(high[i] - low[i]):
                continue
            centre, half = 0.5 * (low[i] + high[i]), 0.5 * (high[i] - low[i])
            if np.isfinite(reach[i]):
                lattice.append(absolute(x - centre) - (half + reach[i]))
            if i in self.repeated:
                cell = floor(x / self.spacing[i] + 0.5)
                if self.copies is not None:
                    cell = clip(cell, -float(self.copies), float(self.copies))
                local[i] = x - self.spacing[i] * cell
                boxes.append(absolute(local[i] - centre) - half)
                safe = 0.5 * (self.spacing[i] + gaps[i])
                faces.append(self._beyond(cell, 1, safe - local[i]))
                faces.append(self._beyond(cell, -1, safe + local[i]))
        own = reduce(maximum, boxes, self.child.distance(Point(*local)))
        return reduce(maximum, lattice, reduce(minimum, faces, own))

    def bounds(self, level=0.0):
        low, high = self.child.bounds(level)
        if level > 0 and self.repeated:  # f may be small between the copies, too
            low, high = self._roomy_box()
            low, high = low - level, high + level
        return low - self._reach(), high + self._reach()

    def _reach(self):
        """How far (3,) the outermost copy is from the first."""
        copies = np.inf if self.copies is None else self.copies
        return np.array([copies * plain(s) if s > 0 else 0.0 for s in plain(self.spacing)])

    def _gaps(self):
        """What the child leaves (3,) free in its cell; elsewhere as much as it leaves at most."""
        low, high = self.child.bounds()
        gaps = plain(self.spacing) / 2 - np.maximum(-low, high)
        return np.array([gaps[i if i in self.repeated else self.repeated].max() for i in range(3)])

    def _roomy_box(self):
        """The box of the child, with half of the gap on each side."""
        low, high = self.child.bounds()
        return low - self._gaps() / 2, high + self._gaps() / 2

    def _beyond(self, cell, side, distance):
        """The `distance` to what lies beyond a face of a cell; very far where that is nothing."""
        if self.copies is None:
            return distance
        return select(side * cell < self.copies - 0.5, distance, 1e30)
