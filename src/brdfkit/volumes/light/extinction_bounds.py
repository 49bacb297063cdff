"""Upper bounds of the extinction of a volume of Mitsuba's, in a few coarse cells of its box."""

import numpy as np

from brdfkit.volumes.light.majorants import Majorants
from brdfkit.volumes.rays.along_ray import to_cube


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
