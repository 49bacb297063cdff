"""Frames of parts: affine maps from the world, and rays in them."""

import numpy as np

from brdfkit.mitsuba_bridge.arrays import Rows


class Frames:
    """The frames of `n` parts, `maps` (n, 3, 4) from the world."""

    def __init__(self, maps):
        self.rows = Rows(np.reshape(maps, (-1, 4)))

    def ray(self, number, ray, active=True):
        """The origin and the direction of a ray in frame `number`.

        The direction is as long as the map makes it, so that distances are those of the ray.
        """
        import drjit as dr
        import mitsuba as mi

        rows = [self.rows.at(3 * number + k, mi.Vector4f, active) for k in range(3)]
        linear = [mi.Vector3f(row.x, row.y, row.z) for row in rows]
        origin = (dr.dot(a, ray.o) + row.w for a, row in zip(linear, rows, strict=True))
        return mi.Vector3f(*origin), mi.Vector3f(*(dr.dot(a, ray.d) for a in linear))
