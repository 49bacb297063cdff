"""Changes of a gridvolume's values from a voxel to the next, to choose how rays sample it."""

from collections.abc import Iterator

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, MitsubaObject

COMPARED_VOXELS = 1_000_000  # about, evenly spread
SHARE = 0.25  # of the way from one voxel to the next, where the volume is tested


def typical_difference(data: AnyArray) -> float:
    """Return the root mean square difference of neighbouring values (nz, ny, nx)."""
    squares = [np.square(ahead - here, dtype=float) for _, here, ahead in _neighbours(data)]
    return float(np.sqrt(np.mean(np.concatenate([s.ravel() for s in squares] or [[0.0]]))))


def is_trilinear(volume: MitsubaObject, data: AnyArray, to_local: MitsubaObject) -> bool:
    """Return whether a volume interpolates between its voxels, which no property of it tells.

    It is evaluated between the two neighbours that differ most; True if all values are equal.
    `data` are its values (nz, ny, nx), `to_local` is the transform from the world to its cube.
    """
    import mitsuba as mi

    ways = [(np.abs(ahead - here), axis) for axis, here, ahead in _neighbours(data)]
    steps, axis = max(ways, key=lambda way: way[0].max(), default=(np.zeros((1, 1, 1)), 0))
    largest = float(steps.max())
    if not largest:
        return True
    first = _stride(data) * np.array(np.unravel_index(steps.argmax(), steps.shape))
    second = first + np.eye(3, dtype=int)[axis]
    kji = (1 - SHARE) * first + SHARE * second
    place = (kji[::-1] + 0.5) / data.shape[::-1]
    it = dr.zeros(mi.Interaction3f)
    it.p = to_local.inverse() @ mi.Point3f(*place.tolist())
    expected = (1 - SHARE) * float(data[tuple(first)]) + SHARE * float(data[tuple(second)])
    return bool(abs(float(volume.eval_1(it)[0]) - expected) < SHARE / 2 * largest)


def _neighbours(data: AnyArray) -> Iterator[tuple[int, AnyArray, AnyArray]]:
    """Yield (axis, values, values of the next voxels) for each axis that has two voxels or more."""
    k = _stride(data)
    for axis, n in enumerate(data.shape):
        if n > 1:
            along = np.moveaxis(data, axis, 0)
            here, ahead = (np.moveaxis(part, 0, axis) for part in (along[:-1], along[1:]))
            yield axis, here[::k, ::k, ::k], ahead[::k, ::k, ::k]


def _stride(data: AnyArray) -> int:
    """Return every how many voxels along an axis are compared."""
    return int(np.ceil((data.size / COMPARED_VOXELS) ** (1 / 3)))
