"""Plane maps: the plane of the face through which a ray from inside leaves a convex part.

A part lies behind each of its planes. Seen from the origin of its unit frame, every direction D
leaves it through one face: that of the largest n·D / d. [Ergun 2015, section 7.1]
"""

import numpy as np

from brdfkit.core.geometry import dual_paraboloid
from brdfkit.mitsuba_bridge.arrays import Integers, Rows, cell

LEAST_SIDE = 8  # texels
TEXELS_AT_ONCE = 1024


class ExactPlaneMap:
    """The true face of each part of `hulls` by direction, found among all of its faces."""

    def __init__(self, hulls):
        self.planes = Rows(np.concatenate([hull.planes for hull in hulls]))
        self.first = Integers(np.cumsum([0] + [len(hull.planes) for hull in hulls]))

    def at(self, part, direction, active=True):
        """The plane of a part in a unit `direction`: its normal and its distance."""
        import drjit as dr
        import mitsuba as mi

        def compare(i, largest, plane):
            candidate = self.planes.at(i, mi.Vector4f, active)
            value = dr.dot(_normal(candidate), direction) / candidate.w
            nearer = value > largest
            return i + 1, dr.select(nearer, value, largest), dr.select(nearer, candidate, plane)

        end = self.first.at(part + 1, active)
        _, _, plane = dr.while_loop(
            (self.first.at(part, active), mi.Float(0), mi.Vector4f(0, 0, 1, 1)),
            lambda i, largest, plane: active & (i < end),
            compare,
        )
        return _normal(plane), plane.w


class RasterisedPlaneMap:
    """The faces of each part of `hulls` in an atlas of dual-paraboloid maps, nearest texel.

    resolution : side of the map of the largest part, in texels; a smaller part has a smaller map.

    The atlas is a list of texels, the map of one part after that of another, each with the square
    of z ≥ 0 before that of z < 0.
    """

    def __init__(self, hulls, resolution):
        radii = np.array([hull.radius for hull in hulls])
        sides = np.ceil(resolution * radii / radii.max()).astype(int)
        sides = np.clip(sides, min(LEAST_SIDE, resolution), resolution)
        maps = [texels(hull, side) for hull, side in zip(hulls, sides, strict=True)]
        self.sides = Integers(sides)
        self.first = Integers(np.cumsum([0, *(2 * sides**2)]))
        self.atlas = Rows(np.concatenate([found.reshape(-1, 4) for found in maps]))

    def at(self, part, direction, active=True):
        """The plane of a part in a unit `direction`: its normal and its distance."""
        import drjit as dr
        import mitsuba as mi

        side = self.sides.at(part, active)
        s, t = dual_paraboloid.to_disc(direction.x, direction.y, direction.z)
        x, y = (cell((c + 1) * 0.5 * mi.Float(side), side) for c in (s, t))
        y = y + dr.select(direction.z < 0, side, 0)
        plane = self.atlas.at(self.first.at(part, active) + y * side + x, mi.Vector4f, active)
        return _normal(plane), plane.w


def texels(hull, side):
    """The plane map (2, side, side, 4) of a `Hull`: z ≥ 0 and z < 0, rows along t, columns s."""
    centres = (np.arange(side) + 0.5) * 2 / side - 1
    t, s = np.meshgrid(centres, centres, indexing="ij")
    both = [np.stack(dual_paraboloid.from_disc(s, t, sign), axis=-1) for sign in (1, -1)]
    directions = np.reshape(both, (-1, 3)).astype(np.float32)
    inverse = (hull.planes[:, :3] / hull.planes[:, 3:]).T.astype(np.float32)
    faces = [
        (directions[start : start + TEXELS_AT_ONCE] @ inverse).argmax(axis=1)
        for start in range(0, len(directions), TEXELS_AT_ONCE)
    ]
    return hull.planes[np.concatenate(faces)].reshape(2, side, side, 4)


def _normal(plane):
    import mitsuba as mi

    return mi.Vector3f(plane.x, plane.y, plane.z)
