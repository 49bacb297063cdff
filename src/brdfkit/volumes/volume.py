"""`Volume`: values on a regular grid of voxels, and the grid's position in the world."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.volumes import downsampling, scene_dictionary
from brdfkit.volumes.rays import reconstruction
from brdfkit.volumes.transfer import windows
from brdfkit.volumes.transfer.transfer_function import TransferLike

LARGEST_COORDINATE = 1e15  # limit of a transform's numbers, so that their products fit into float32
LARGEST_VALUE = 1e30  # limit of values, and of 1 / (their range), for renderers in float32


@dataclass(frozen=True, eq=False, repr=False)
class Volume:
    """Values on a regular grid of voxels; `volumes.load` reads it from a file.

    Raises `BrdfkitError` if there are no voxels, a value is not finite, or all values are 0.

    Attributes
    ----------
    values : ndarray
        Values (nz, ny, nx), float32 or integers, x fastest as in Mitsuba's grids. float64 is
        converted to float32, booleans to uint8.
    to_world : ndarray
        Transform (4, 4) from the indices (i, j, k) of a voxel along x, y, z to its centre in the
        world, in the file's unit of length. None is the identity.
    name : str
        The volume's name.
    labels : bool
        Whether values are labels of tissues or materials, which are never averaged or
        interpolated. Whole numbers in floats are converted to integers.
    unit : str
        The unit of length, such as "mm"; empty if it is unknown, and printed as "units".
    axes : str
        "RAS" if x, y and z of the world point to the patient's right, front and head; empty for
        other data.

    Examples
    --------
    >>> Volume(np.arange(24).reshape(2, 3, 4), np.diag([0.5, 0.5, 2, 1]), "ramp", unit="mm")
    ramp: 4×3×2 voxels of 0.5×0.5×2 mm, int64, 0 to 23
    """

    values: NDArray
    to_world: Any = None
    name: str = "volume"
    labels: bool = False
    unit: str = ""
    axes: str = ""

    def __post_init__(self) -> None:
        to_world = np.eye(4) if self.to_world is None else np.array(self.to_world, float)
        object.__setattr__(self, "values", _check_values(self.values, self.name, self.labels))
        object.__setattr__(self, "to_world", require_transform(to_world, self.name))

    @property
    def size(self) -> tuple[int, int, int]:
        """The numbers of voxels along x, y, z."""
        nz, ny, nx = self.values.shape
        return nx, ny, nz

    @property
    def spacing(self) -> tuple[float, float, float]:
        """The distances between voxels' centres along the axes x, y, z of the grid."""
        x, y, z = np.linalg.norm(self.to_world[:3, :3], axis=0).tolist()
        return x, y, z

    @property
    def cube_to_world(self) -> NDArray[np.float64]:
        """The transform (4, 4) from the unit cube to the box of all voxels, as for `gridvolume`.

        The cube's corners are corners of voxels; centres lie half a voxel further in.
        """
        to_indices = np.diag([*self.size, 1.0])
        to_indices[:3, 3] = -0.5
        return self.to_world @ to_indices

    @property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The corners (low, high) of the smallest box along the world's axes around all voxels."""
        corners = np.indices((2, 2, 2)).reshape(3, -1)
        points = self.cube_to_world[:3] @ np.vstack([corners, np.ones(8)])
        return points.min(axis=1), points.max(axis=1)

    @cached_property
    def range(self) -> tuple[float, float]:
        """The smallest and the largest value."""
        return float(self.values.min()), float(self.values.max())

    @cached_property
    def window(self) -> tuple[float, float]:
        """The range (low, high) of the matter's values, for `TransferFunction.scaled_to`.

        It is found from the histogram: the background, such as air, lies below, and only a few
        bright voxels lie above.
        """
        return windows.find_window(self.values)

    @cached_property
    def gradient_magnitude(self) -> NDArray[np.float32]:
        """The gradient magnitude ‖∇V‖ (nz, ny, nx) at voxels' centres [value per unit of length].

        It is computed by central differences, and by one-sided differences at the grid's faces.
        """
        return reconstruction.gradient_magnitude(self.values, self.to_world)

    def resized(self, factor: int) -> Volume:
        """Return the volume downsampled: each block of factor × factor × factor voxels is averaged.

        Blocks at the upper ends of the grid may be smaller. Labels are not averaged: a block gets
        the label of the voxel in its middle.
        """
        factor = to_whole_number("factor", factor, 1)
        slabs = (self.values[k : k + factor] for k in range(0, len(self.values), factor))
        values = np.stack(
            [downsampling.downsample_slab(slab, factor, self.labels) for slab in slabs]
        )
        to_world = downsampling.downsample_transform(self.to_world, factor)
        return Volume(values, to_world, self.name, self.labels, self.unit, self.axes)

    def __call__(self, points: ArrayLike) -> NDArray:
        """Return the values (n,) at `points` (n, 3) of the world, by trilinear interpolation.

        Labels are those of the nearest voxel. Beyond the centres of the outermost voxels the value
        is constant; outside the box it is 0.
        """
        return reconstruction.interpolate_values(self, points)

    def gradient(self, points: ArrayLike, of_interpolant: bool = False) -> NDArray[np.float64]:
        """Return the gradient (n, 3) of the values at `points` (n, 3) of the world.

        Its unit is that of values per unit of length. By default it is a central difference over a
        voxel to either side; with `of_interpolant` it is the derivative of the trilinear
        interpolant, which jumps at the centres of voxels.
        """
        return reconstruction.compute_gradients(self, points, of_interpolant)

    def scene_dict(self, transfer: TransferLike | None = None) -> dict[str, Any]:
        """Return the dictionary of the volume for `mitsuba.load_dict`, in the current variant.

        Parameters
        ----------
        transfer : TransferFunction, str or Path, optional
            The transfer function, a preset's name, or a file, for media and brdfkit's integrators.
            Its lengths are converted to the volume's unit. None gives the values alone.

        Returns
        -------
        dict
            A dictionary of the type "transfer_function", or "gridvolume" for values alone, with the
            volume's transform to the world. Labels are looked up in the nearest voxel.

        Raises
        ------
        BrdfkitError
            If the function cannot be read, or one of two different units of length is unknown.

        Examples
        --------
        >>> head = volumes.load("brain.nii.gz")    # doctest: +SKIP
        >>> {"type": "isosurface", "volume": head.scene_dict()}    # doctest: +SKIP
        """
        return scene_dictionary.make_scene_dict(self, transfer)

    def __repr__(self) -> str:
        low, high = self.range
        spacing = "×".join(f"{s:.4g}" for s in self.spacing)
        kind = "labels" if self.labels else f"{low:.6g} to {high:.6g}"
        return (
            f"{self.name}: {'×'.join(map(str, self.size))} voxels of {spacing}"
            f" {self.unit or 'units'}, {self.values.dtype}, {kind}"
        )


def require_transform(to_world: ArrayLike, name: object) -> FloatArray:
    """Return the transform `to_world` as floats; raise `BrdfkitError` unless it can be used.

    It must be an affine, invertible matrix (4, 4) of numbers that renderers can represent.
    """
    to_world = np.asarray(to_world, float)
    fine = to_world.shape == (4, 4) and np.isfinite(to_world).all()
    fine = fine and (to_world[3] == (0, 0, 0, 1)).all()
    fine = fine and np.abs(to_world).max() < LARGEST_COORDINATE
    fine = fine and np.abs(to_world[:3, :3]).max(axis=0).min() > 1 / LARGEST_COORDINATE
    if not fine or not abs(np.linalg.det(to_world[:3, :3])) > 0:
        raise BrdfkitError(
            f"{name}: its transform from voxels to the world is no invertible 4×4 matrix of "
            "numbers below 1e15: the spacing or an axis is 0, not finite, too small or too large; "
            "correct the header or give the spacing."
        )
    return to_world


def _check_values(values: ArrayLike, name: str, labels: bool) -> AnyArray:
    """Return voxels as a contiguous array of a type that `Volume` allows.

    Raises `BrdfkitError`, which names the volume, if their shape, type or values cannot be used.
    """
    values = np.asarray(values)
    if values.ndim != 3 or not values.size:
        raise BrdfkitError(
            f"{name}: its values have the shape {values.shape}; they should be (nz, ny, nx), with "
            "one voxel or more."
        )
    if values.dtype.kind not in "biuf":
        raise BrdfkitError(f"{name}: its values are {values.dtype}, where real numbers belong.")
    if values.dtype.kind == "f" and not labels:
        with np.errstate(over="ignore"):  # values beyond float32 become infinite
            values = values.astype(np.float32, copy=False)
    low, high = values.min(), values.max()  # infinite or NaN if any value is
    if not (np.isfinite(low) and np.isfinite(high)):
        count = values.size - np.count_nonzero(np.isfinite(values))
        raise BrdfkitError(
            f"{name}: {count:,} of {values.size:,} voxels are not finite (NaN or infinite); "
            "replace them, as by numpy.nan_to_num."
        )
    span, largest = float(high) - float(low), max(-float(low), float(high))
    if largest > LARGEST_VALUE or 0 < span < 1 / LARGEST_VALUE:
        raise BrdfkitError(
            f"{name}: its values, {low:g} to {high:g}, are too large or too close together for "
            "32 bits; multiply them by a number."
        )
    if low == high == 0:
        raise BrdfkitError(f"{name}: all voxels are 0; check that it is the right file.")
    if labels and values.dtype.kind == "f":
        return _convert_labels(values, name)
    boolean = values.dtype.kind == "b"
    return np.ascontiguousarray(values, np.uint8 if boolean else values.dtype.newbyteorder("="))


def _convert_labels(values: AnyArray, name: str) -> AnyArray:
    """Convert labels to integers; raise `BrdfkitError` unless they are whole numbers."""
    with np.errstate(invalid="ignore"):  # values beyond int32 change, which is found below
        whole = values.astype(np.int32)
    if not (whole == values).all():
        raise BrdfkitError(
            f"{name}: its values are not whole numbers, so they cannot be labels; load it without "
            "labels=True."
        )
    return whole
