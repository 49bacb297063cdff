"""How the values of a gridvolume of Mitsuba's change from a voxel to the next one."""

import drjit as dr
import numpy as np

MOST = 1_000_000  # voxels that are asked, evenly spread
SHARE = 0.25  # of the way from one voxel to the next


def typical(data):
    """The root mean square of the differences of neighbours, of values (nz, ny, nx)."""
    squares = [np.square(ahead - here, dtype=float) for _, here, ahead in _neighbours(data)]
    return float(np.sqrt(np.mean(np.concatenate([s.ravel() for s in squares] or [[0.0]]))))


def is_trilinear(volume, data, to_local):
    """Whether the volume has, between two voxels, values between theirs: no property tells.

    It is asked between the two neighbours that differ most. True where all values are equal.
    data : its values; to_local : from the world to its cube.
    """
    import mitsuba as mi

    ways = [(np.abs(ahead - here), axis) for axis, here, ahead in _neighbours(data)]
    steps, axis = max(ways, key=lambda way: way[0].max(), default=(np.zeros((1, 1, 1)), 0))
    most = float(steps.max())
    if not most:
        return True
    first = _stride(data) * np.array(np.unravel_index(steps.argmax(), steps.shape))
    second = first + np.eye(3, dtype=int)[axis]
    kji = (1 - SHARE) * first + SHARE * second
    place = (kji[::-1] + 0.5) / data.shape[::-1]
    it = dr.zeros(mi.Interaction3f)
    it.p = to_local.inverse() @ mi.Point3f(*place.tolist())
    expected = (1 - SHARE) * float(data[tuple(first)]) + SHARE * float(data[tuple(second)])
    return abs(float(volume.eval_1(it)[0]) - expected) < SHARE / 2 * most


def _neighbours(data):
    """For each axis along which there are some: (axis, values, those of the next voxels)."""
    k = _stride(data)
    for axis, n in enumerate(data.shape):
        if n > 1:
            along = np.moveaxis(data, axis, 0)
            here, ahead = (np.moveaxis(part, 0, axis) for part in (along[:-1], along[1:]))
            yield axis, here[::k, ::k, ::k], ahead[::k, ::k, ::k]


def _stride(data):
    return int(np.ceil((data.size / MOST) ** (1 / 3)))
