"""`Majorants`: upper bounds of a volume's extinction, one for each cell of a coarse grid.

The lower the bounds, the fewer look-ups of the extinction `tracking.py` needs to find where light
collides [Szirmay-Kalos et al. 2011]. A grid of a single cell has the global majorant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from brdfkit.core.array_types import (
    AnyArray,
    ArrayLike,
    FloatArray,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaObject,
)
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.padding import pad
from brdfkit.volumes.rays.box import get_world_to_cube
from brdfkit.volumes.transfer.block_bounds import reduce_blocks

CELL_VOXELS = 16  # number of voxels along each edge of a cell
ROUNDING = 1e-5  # relative rounding error by which an interpolated extinction may exceed its bound


@dataclass(frozen=True, eq=False)
class Majorants:
    """Upper bounds of an extinction in the cells of a box, for tracking in Mitsuba.

    `values` (nz, ny, nx) are the bounds [1/unit of length], at least 0, x fastest. The cells divide
    the unit cube evenly; `cube_to_world` (4, 4) transforms it to the world, by default unchanged.
    `array` are the values as a `mitsuba.Float`, for kernels; scalar variants cannot read it.
    Raises `BrdfkitError` if a value is negative or not finite.

    >>> Majorants([[[3.25]]])                       # one bound for the whole unit cube
    >>> Majorants.from_grid(extinction)             # one for each 16³ voxels
    """

    values: Any
    cube_to_world: Any = None
    array: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        import mitsuba as mi

        values = np.array(self.values, np.float32)
        if values.ndim != 3 or not values.size or not (np.isfinite(values) & (values >= 0)).all():
            raise BrdfkitError(
                "Majorants are finite numbers, at least 0, in an array (nz, ny, nx)."
            )
        cube = np.eye(4) if self.cube_to_world is None else np.array(self.cube_to_world, float)
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "cube_to_world", cube)
        object.__setattr__(self, "array", mi.Float(pad(values.ravel())))

    @classmethod
    def from_grid(
        cls, values: ArrayLike, voxels: int = CELL_VOXELS, cube_to_world: ArrayLike | None = None
    ) -> Majorants:
        """Return the bounds of an extinction that is interpolated linearly between voxels.

        `values` (nz, ny, nx) is the extinction at the centres of the voxels [1/unit of length].
        `voxels` is their number along the edge of a cell. Smaller cells need fewer look-ups of the
        extinction, but more steps from cell to cell.
        """
        bounds = np.asarray(values, np.float32)
        for axis, n in enumerate(bounds.shape):
            bounds = reduce_blocks(bounds, axis, -(-n // voxels), np.max)
        return cls(bounds, cube_to_world)

    def require_extinction_below(
        self,
        extinction: Callable[[JitVector, JitMask], JitFloat],
        samples: int = 1 << 18,
        seed: int = 0,
    ) -> None:
        """Raise `BrdfkitError` if an extinction exceeds its majorant, or is negative, at a point.

        `extinction(p, active)` is evaluated at random points `p` of the box, whose number is
        `samples`; violations between these points go unnoticed.

        >>> Majorants([[[1.5]]]).require_extinction_below(lambda p, active: 0.25 + 3 * p.x)
        brdfkit.core.errors.BrdfkitError: The extinction is 3.25 at (1, 0.42, 0.8), its ...
        """
        import mitsuba as mi

        u = np.random.default_rng(seed).random((samples, 3))
        i, j, k = (u * self.shape).astype(int).T
        bound = self.values[k, j, i]
        p = u @ self.cube_to_world[:3, :3].T + self.cube_to_world[:3, 3]
        points = mi.Point3f(*(mi.Float(pad(c.astype(np.float32))) for c in p.T))
        sigma = np.broadcast_to(np.array(extinction(points, mi.Bool(True))), len(u))
        if (sigma < 0).any():
            place = _format_point(p[int(sigma.argmin())])
            raise BrdfkitError(
                f"The extinction is {sigma.min():.4g} at {place}, but it cannot be negative: clip "
                "it at 0, for example after each step of an optimiser."
            )
        above = ~(sigma <= bound * (1 + ROUNDING))  # negated, so that NaN fails as well
        if above.any():
            worst = int(np.argmax(np.where(above, sigma - bound, 0)))
            raise BrdfkitError(
                f"The extinction is {sigma[worst]:.4g} at {_format_point(p[worst])}, its majorant "
                f"{bound[worst]:.4g}: no bound, and pictures would be wrong; raise the majorant, "
                "or take the global one if the grid is turned, mirrored or repeated in its box."
            )

    @property
    def shape(self) -> tuple[int, int, int]:
        """The number of cells along x, y, z."""
        nz, ny, nx = self.values.shape
        return nx, ny, nz

    @property
    def world_to_cells(self) -> FloatArray:
        """The transform (4, 4) from the world to coordinates in which the cells are unit cubes."""
        return np.diag([*self.shape, 1.0]) @ np.linalg.inv(self.cube_to_world)


def _format_point(p: FloatArray) -> str:
    """Format the coordinates of a point (3,) for an error message."""
    return f"({', '.join(f'{c:.3g}' for c in p)})"


def compute_majorants(volume: MitsubaObject, scale: JitFloat, local: bool) -> Majorants:
    """Return the `Majorants` of the extinction that is a Mitsuba volume times a `scale`.

    They have a single cell, or coarse cells if `local`. The bounds of a gridvolume and of the
    plugin `transfer_function` are computed from voxels; any other volume's `max()` is trusted.
    """
    if hasattr(volume, "majorants"):
        bounds = volume.majorants
    elif (data := read_grid_values(volume)) is not None:
        bounds = Majorants.from_grid(data).values
    else:
        bounds = np.reshape(volume.max(), (1, 1, 1))
    if not local:
        bounds = bounds.max(keepdims=True)
    box = np.array(get_world_to_cube(volume).matrix, float).reshape(4, 4)
    return Majorants(bounds * scale[0], np.linalg.inv(box))


def read_grid_values(volume: MitsubaObject) -> AnyArray | None:
    """Return the voxels' values (nz, ny, nx) of a Mitsuba gridvolume, None for another volume."""
    import mitsuba as mi

    data = mi.traverse(volume).get("data")
    return None if data is None else np.asarray(data)[..., 0]  # no copy: there may be many
