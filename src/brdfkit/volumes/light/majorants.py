"""`Majorants`: upper bounds of a volume's extinction, one for each of a few coarse cells.

The lower the bounds, the fewer the look-ups by which `tracking.py` finds where light collides
[Szirmay-Kalos et al. 2011]. A single cell is the global majorant.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.padding import pad
from brdfkit.volumes.rays.along_ray import to_cube
from brdfkit.volumes.transfer.block_bounds import along_blocks

VOXELS = 16  # along the edges of a cell
ROUNDING = 1e-5  # by which an interpolated extinction may exceed what it is interpolated from


@dataclass(frozen=True, eq=False)
class Majorants:
    """Upper bounds of an extinction in the cells of a box, for the current variant of Mitsuba's.

    Attributes
    ----------
    values : array (nz, ny, nx)
        The bounds [1/unit of length], at least 0; x fastest.
    cube_to_world : array (4, 4), optional
        From the unit cube, in which the cells lie, to the world; by default the identity.
    array : mitsuba.Float
        The values in Dr.Jit's memory.

    It has no use in scalar variants.

    Raises
    ------
    BrdfkitError
        For values that are no bounds.

    Examples
    --------
    >>> Majorants([[[3.25]]])                       # one bound for all of the unit cube
    >>> Majorants.of_grid(extinction)               # one for each 16³ voxels
    """

    values: NDArray
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
    def of_grid(
        cls, values: ArrayLike, voxels: int = VOXELS, cube_to_world: ArrayLike | None = None
    ) -> "Majorants":
        """The bounds of voxels' values, and of what is interpolated from them linearly.

        Parameters
        ----------
        values : array (nz, ny, nx)
            The extinction at the centres of the voxels [1/unit of length], at least 0.
        voxels : int, default 16
            Voxels along the edge of a cell, at least 1: fewer take fewer look-ups and more steps.
        cube_to_world : array (4, 4), optional
            From the unit cube, which the voxels fill, to the world; by default the identity.

        Raises
        ------
        BrdfkitError
            For values that have no bounds, and for less than a voxel.

        Examples
        --------
        >>> Majorants.of_grid(np.ones((64, 64, 64))).values.shape
        (4, 4, 4)
        """
        found = np.asarray(values, np.float32)
        voxels = to_whole_number("voxels", voxels, 1)
        for axis, n in enumerate(found.shape):
            found = along_blocks(found, axis, -(-n // voxels), np.max)
        return cls(found, cube_to_world)

    def require(
        self, extinction: Callable[[Any, Any], Any], samples: int = 1 << 18, seed: int = 0
    ) -> None:
        """Raise an error if an extinction is above its majorant, or below 0, at a random point.

        That none is found is no proof, except for what `of_grid` bounds.

        Parameters
        ----------
        extinction : callable
            σ(p, active) of a `mitsuba.Point3f` in the world.
        samples : int, default 262,144
            How many points are drawn.
        seed : int, default 0
            Of the random numbers.

        Raises
        ------
        BrdfkitError
            For an extinction above its majorant, below 0 or not finite; it says where.

        Examples
        --------
        >>> Majorants([[[1.5]]]).require(lambda p, active: 0.25 + 3 * p.x)
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
            raise BrdfkitError(
                f"The extinction is {sigma.min():.4g} at {_place(p[int(sigma.argmin())])}, and a "
                "volume cannot add to light: clip it at 0, as after a step of an optimiser."
            )
        above = ~(sigma <= bound * (1 + ROUNDING))  # or no number
        if above.any():
            worst = int(np.argmax(np.where(above, sigma - bound, 0)))
            raise BrdfkitError(
                f"The extinction is {sigma[worst]:.4g} at {_place(p[worst])}, its majorant "
                f"{bound[worst]:.4g}: no bound, and pictures would be wrong; raise the majorant; "
                "of a grid that is turned, mirrored or repeated in its box take the global one."
            )

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of cells along x, y, z."""
        nz, ny, nx = self.values.shape
        return nx, ny, nz

    @property
    def world_to_cells(self) -> NDArray[np.float64]:
        """(4, 4): from the world to where a cell is a unit cube, the first from (0, 0, 0)."""
        return np.diag([*self.shape, 1.0]) @ np.linalg.inv(self.cube_to_world)


def _place(p):
    return f"({', '.join(f'{c:.3g}' for c in p)})"


def extinction_bounds(volume, scale, local):
    """`Majorants` of a volume times a `scale`: of coarse cells if `local`, else one for all of it.

    Those of a gridvolume and of a `transfer_function` are found from their values; of another
    volume its `max()` is taken at its word.
    """
    if hasattr(volume, "majorants"):
        bounds = volume.majorants
    elif (data := data_of(volume)) is not None:
        bounds = Majorants.of_grid(data).values
    else:
        bounds = np.reshape(volume.max(), (1, 1, 1))
    if not local:
        bounds = bounds.max(keepdims=True)
    box = np.array(to_cube(volume).matrix, float).reshape(4, 4)
    return Majorants(bounds * scale[0], np.linalg.inv(box))


def data_of(volume):
    """The values (nz, ny, nx) of a gridvolume, in NumPy; None of another volume."""
    import mitsuba as mi

    data = mi.traverse(volume).get("data")
    return None if data is None else np.array(data)[..., 0]
