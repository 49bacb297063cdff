"""Plane maps store, for each direction from the centre of a convex part, the plane of the face.

Coordinates are those of the part's unit frame, in which the unit sphere encloses it. The part lies
behind each of its planes n·x = d. A ray from the origin with the direction D leaves it through the
face with the largest n·D / d. [Ergun 2015, section 7.1]
"""

from typing import Protocol

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.core.geometry import dual_paraboloid
from brdfkit.lighting.visibility.hull import Hull
from brdfkit.mitsuba_bridge.arrays import Integers, Rows, find_cell

SMALLEST_SIDE = 8  # texels along a side of the map of a small part
CHUNK = 1024  # texels that are computed at once, to save memory


class PlaneMap(Protocol):
    """A look-up of the planes of convex parts by direction, as `find_ray_entry` needs it."""

    def look_up_plane(
        self, part: JitInt, direction: JitVector, active: JitMask = True
    ) -> tuple[JitVector, JitFloat]:
        """Return the normal and distance of the face that a part has in a unit `direction`."""


class RasterisedPlaneMap:
    """The plane maps of convex parts, the `hulls`, as dual-paraboloid pictures of nearest texels.

    `resolution` is the side of the map of the largest part [texels]; smaller parts have smaller
    maps. All texels are stored in one list, map after map, with the square of the hemisphere z ≥ 0
    before that of z < 0.
    """

    def __init__(self, hulls: list[Hull], resolution: int) -> None:
        radii = np.array([hull.radius for hull in hulls])
        sides = np.ceil(resolution * radii / radii.max()).astype(int)
        sides = np.clip(sides, min(SMALLEST_SIDE, resolution), resolution)
        maps = [rasterise_planes(hull, side) for hull, side in zip(hulls, sides, strict=True)]
        self.sides = Integers(sides)
        self.first = Integers(np.cumsum([0, *(2 * sides**2)]))
        self.atlas = Rows(np.concatenate([texels.reshape(-1, 4) for texels in maps]))

    def look_up_plane(
        self, part: JitInt, direction: JitVector, active: JitMask = True
    ) -> tuple[JitVector, JitFloat]:
        """Return the normal and distance of the face that a part has in a unit `direction`."""
        import drjit as dr
        import mitsuba as mi

        side = self.sides.at(part, active)
        s, t = dual_paraboloid.to_disc(direction.x, direction.y, direction.z)
        x, y = (find_cell((c + 1) * 0.5 * mi.Float(side), side) for c in (s, t))
        y = y + dr.select(direction.z < 0, side, 0)
        plane = self.atlas.at(self.first.at(part, active) + y * side + x, mi.Vector4f, active)
        return mi.Vector3f(plane.x, plane.y, plane.z), plane.w


def rasterise_planes(hull: Hull, side: int) -> FloatArray:
    """Return the plane map (2, side, side, 4) of a hull: (n, d), for z ≥ 0, then for z < 0."""
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
