"""Differences between neighbouring voxels of a gridvolume, to choose how rays sample the volume."""

from collections.abc import Iterator

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, MitsubaObject

COMPARED_VOXELS = 1_000_000  # approximate number of voxels that are compared, evenly spread
SHARE = 0.25  # `is_trilinear` evaluates the volume at this share of the way between two voxels


def rms_neighbour_difference(data: AnyArray) -> float:
    """Return the root mean square difference between neighbours of the voxels (nz, ny, nx)."""
    squares = [np.square(ahead - here, dtype=float) for _, here, ahead in _pair_neighbours(data)]
    return float(np.sqrt(np.mean(np.concatenate([s.ravel() for s in squares] or [[0.0]]))))


def is_trilinear(volume: MitsubaObject, data: AnyArray, to_local: MitsubaObject) -> bool:
    """Return whether a Mitsuba volume interpolates between its voxels, whose values are `data`.

    Mitsuba does not expose this property, so the volume is evaluated between the two neighbours
    that differ most. The answer is True if all values are equal. `data` has the shape
    (nz, ny, nx), and `to_local` is the transform from the world to the volume's unit cube.
    """
    import mitsuba as mi

    ways = [(np.abs(ahead - here), axis) for axis, here, ahead in _pair_neighbours(data)]
    steps, axis = max(ways, key=lambda way: way[0].max(), default=(np.zeros((1, 1, 1)), 0))
    largest = float(steps.max())
    if not largest:
        return True
    first = _choose_comparison_stride(data) * np.array(
        np.unravel_index(steps.argmax(), steps.shape)
    )
    second = first + np.eye(3, dtype=int)[axis]
    kji = (1 - SHARE) * first + SHARE * second
    place = (kji[::-1] + 0.5) / data.shape[::-1]
    it = dr.zeros(mi.Interaction3f)
    it.p = to_local.inverse() @ mi.Point3f(*place.tolist())
    expected = (1 - SHARE) * float(data[tuple(first)]) + SHARE * float(data[tuple(second)])
    return bool(abs(float(volume.eval_1(it)[0]) - expected) < SHARE / 2 * largest)


def _pair_neighbours(data: AnyArray) -> Iterator[tuple[int, AnyArray, AnyArray]]:
    """Yield (axis, values, values of the next voxels along it) for each axis with 2 voxels or more.

    The values are an evenly spread part of the voxels `data` (nz, ny, nx).
    """
    k = _choose_comparison_stride(data)
    for axis, n in enumerate(data.shape):
        if n > 1:
            along = np.moveaxis(data, axis, 0)
            here, ahead = (np.moveaxis(part, 0, axis) for part in (along[:-1], along[1:]))
            yield axis, here[::k, ::k, ::k], ahead[::k, ::k, ::k]


def _choose_comparison_stride(data: AnyArray) -> int:
    """Return the step along each axis, in voxels, that leaves about COMPARED_VOXELS of `data`."""
    return int(np.ceil((data.size / COMPARED_VOXELS) ** (1 / 3)))
