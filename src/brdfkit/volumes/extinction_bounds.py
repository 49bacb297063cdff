"""Upper bounds of the extinction of a volume of Mitsuba's, in a few coarse cells of its box."""

import numpy as np

from brdfkit.volumes.majorants import Majorants


def extinction_bounds(volume, scale, local):
    """`Majorants` of a volume times a `scale`: of coarse cells if `local`, else one for all of it.

    Those of a gridvolume and of a `transfer_function` are found from their values; of another
    volume its `max()` is taken at its word.
    """
    import mitsuba as mi

    data = mi.traverse(volume).get("data")
    if hasattr(volume, "majorants"):
        bounds = volume.majorants
    elif data is not None:
        bounds = Majorants.of_grid(np.array(data)[..., 0]).values
    else:
        bounds = np.reshape(volume.max(), (1, 1, 1))
    if not local:
        bounds = bounds.max(keepdims=True)
    return Majorants(bounds * scale[0], box_to_world(volume))


def box_to_world(volume):
    """(4, 4): from the unit cube to the box of a volume, oblique where that has a `to_local`."""
    to_local = getattr(volume, "to_local", None)
    if to_local is not None:
        return np.linalg.inv(np.array(to_local.matrix, float).reshape(4, 4))
    box = volume.bbox()
    cube = np.diag([*np.array(box.extents(), float), 1.0])
    cube[:3, 3] = np.array(box.min, float)
    return cube
