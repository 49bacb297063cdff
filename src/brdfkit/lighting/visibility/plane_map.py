"""Plane maps: the plane of the face through which a ray from inside leaves a convex part.

A part lies behind each of its planes n·x = d. Seen from the origin of its unit frame, a direction D
leaves the part through the face with the largest n·D / d. [Ergun 2015, section 7.1]
"""

from typing import Protocol

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.core.geometry import dual_paraboloid
from brdfkit.lighting.visibility.hull import Hull
from brdfkit.mitsuba_bridge.arrays import Integers, Rows, find_cell

SMALLEST_SIDE = 8  # texels
CHUNK = 1024  # texels that are computed at once


class PlaneMap(Protocol):
    """The planes of convex parts by direction."""

    def at(
        self, part: JitInt, direction: JitVector, active: JitMask = True
    ) -> tuple[JitVector, JitFloat]:
        """Return the normal and the distance of a part's plane in a unit `direction`."""


class RasterisedPlaneMap:
    """The faces of each part of `hulls` in an atlas of dual-paraboloid maps, nearest texel.

    `resolution` is the side of the map of the largest part [texels]; a smaller part has a smaller
    map. The atlas is a list of texels, the map of one part after another, each with the square of
    z ≥ 0 before that of z < 0.
    """

    def __init__(self, hulls: list[Hull], resolution: int) -> None:
        radii = np.array([hull.radius for hull in hulls])
        sides = np.ceil(resolution * radii / radii.max()).astype(int)
        sides = np.clip(sides, min(SMALLEST_SIDE, resolution), resolution)
        maps = [rasterise(hull, side) for hull, side in zip(hulls, sides, strict=True)]
        self.sides = Integers(sides)
        self.first = Integers(np.cumsum([0, *(2 * sides**2)]))
        self.atlas = Rows(np.concatenate([texels.reshape(-1, 4) for texels in maps]))

    def at(
        self, part: JitInt, direction: JitVector, active: JitMask = True
    ) -> tuple[JitVector, JitFloat]:
        """Return the normal and the distance of a part's plane in a unit `direction`."""
        import drjit as dr
        import mitsuba as mi

        side = self.sides.at(part, active)
        s, t = dual_paraboloid.to_disc(direction.x, direction.y, direction.z)
        x, y = (find_cell((c + 1) * 0.5 * mi.Float(side), side) for c in (s, t))
        y = y + dr.select(direction.z < 0, side, 0)
        plane = self.atlas.at(self.first.at(part, active) + y * side + x, mi.Vector4f, active)
        return mi.Vector3f(plane.x, plane.y, plane.z), plane.w


def rasterise(hull: Hull, side: int) -> FloatArray:
    """Return the plane map (2, side, side, 4) of a hull: z ≥ 0 and z < 0, rows along t."""
    centres = (np.arange(side) + 0.5) * 2 / side - 1
    t, s = np.meshgrid(centres, centres, indexing="ij")
    both = [np.stack(dual_paraboloid.from_disc(s, t, sign), axis=-1) for sign in (1, -1)]
    directions = np.reshape(both, (-1, 3)).astype(np.float32)
    inverse = (hull.planes[:, :3] / hull.planes[:, 3:]).T.astype(np.float32)
    faces = [
        (directions[start : start + CHUNK] @ inverse).argmax(axis=1)
        for start in range(0, len(directions), CHUNK)
    ]
    return hull.planes[np.concatenate(faces)].reshape(2, side, side, 4)
