"""`Occluders`: movable objects that consist of convex parts, to test whether they block rays."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import JitFloat, JitInt, JitMask, MitsubaObject
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.lighting.visibility.convex_ray import find_ray_entry
from brdfkit.lighting.visibility.hierarchy import Hierarchy
from brdfkit.lighting.visibility.hull import Frames, Hull
from brdfkit.lighting.visibility.plane_map import RasterisedPlaneMap
from brdfkit.mitsuba_bridge.arrays import Rows

RESOLUTION = 128  # texels along a side of the largest convex part's map of planes
CLEARANCE = 0.03  # largest bulge of hulls beyond their object, relative to half its longest side


class Occluders:
    """Objects that cast shadows by their convex parts, and that can be moved.

    `objects` maps names to lists of parts; there must be at least one part. `resolution` is the
    side of the plane map of the largest part [texels]. A part that a ray enters at a distance below
    the `clearance`, a share of half the longest side of its object's bounding box, does not block
    it. The reason is that the hulls bulge out where the mesh is hollow, and would otherwise draw
    dark lines on the mesh along the seams of parts.
    """

    def __init__(
        self,
        objects: dict[Any, list[Hull]],
        resolution: int = RESOLUTION,
        clearance: float = CLEARANCE,
    ) -> None:
        self.hulls = [hull for parts in objects.values() for hull in parts]
        if not self.hulls:
            raise BrdfkitError("There are no convex parts; give an object that encloses a volume.")
        lengths = [len(parts) for parts in objects.values()]
        ends = np.cumsum(lengths)
        self._parts = {
            name: slice(end - len(parts), end)
            for (name, parts), end in zip(objects.items(), ends, strict=True)
        }
        self._vertices = np.concatenate([hull.vertices for hull in self.hulls])
        counts = [len(hull.vertices) for hull in self.hulls]
        self._starts = np.cumsum([0, *counts[:-1]])
        self._vertex_part = np.repeat(np.arange(len(self.hulls)), counts)
        self._to_world = np.tile(np.eye(4), (len(self.hulls), 1, 1))
        self.maps = RasterisedPlaneMap(self.hulls, resolution)
        self.clearance = Rows(
            np.repeat([clearance * _half_longest_side(p) for p in objects.values()], lengths)
        )
        self._update_tree()

    def move(self, name: str, to_world: Any) -> None:
        """Move the object `name` from its original position by the matrix `to_world` (4, 4).

        Raises `BrdfkitError` for an unknown object, and for a matrix that cannot be inverted.
        """
        if name not in self._parts:
            raise no_such_error("object", name, self._parts)
        matrix = np.asarray(to_world, float)
        if matrix.shape != (4, 4) or not abs(np.linalg.det(matrix)) > 0:
            raise BrdfkitError(f"{name}: to_world should be an invertible matrix (4, 4).")
        self._to_world[self._parts[name]] = matrix
        self._update_tree()

    def _update_tree(self) -> None:
        """Compute the tree of bounding boxes and the parts' transforms after objects have moved."""
        world = self._to_world[self._vertex_part]
        placed = np.einsum("nij,nj->ni", world[:, :3, :3], self._vertices) + world[:, :3, 3]
        low = np.minimum.reduceat(placed, self._starts)
        high = np.maximum.reduceat(placed, self._starts)
        self.tree = Hierarchy(low, high)
        to_unit = np.stack([hull.to_unit for hull in self.hulls])
        self.frames = Frames(to_unit @ np.linalg.inv(self._to_world))

    def is_blocked(self, ray: MitsubaObject, active: JitMask = True) -> tuple[JitMask, JitInt]:
        """Return whether a part blocks a ray before its `maxt`, and the number of plane look-ups.

        A part that contains the ray's origin does not block it, since the origin is a point on the
        surface of that part.
        """

        def test_part(part: JitInt, active: JitMask) -> tuple[JitMask, JitInt]:
            t, entered, reads = self._find_part_entry(ray, part, active)
            return entered & (t >= self.clearance.at(part, active=active)) & (t < ray.maxt), reads

        return self.tree.find_any_hit(ray, test_part, active)

    def _find_part_entry(
        self, ray: MitsubaObject, part: JitInt, active: JitMask
    ) -> tuple[JitFloat, JitMask, JitInt]:
        """Find where a ray in world coordinates enters a part, by `find_ray_entry`."""
        import drjit as dr
        import mitsuba as mi

        o, d = self.frames.transform_ray(part, ray, active)
        length = dr.select(active, dr.norm(d), 1)
        t, entered, count = find_ray_entry(mi, o, d / length, self.maps, part, active)
        return t / length, entered, count


def _half_longest_side(parts: list[Hull]) -> float:
    """Return half of the longest side of the bounding box of convex `parts`; 0 for none."""
    vertices = np.concatenate([hull.vertices for hull in parts]) if parts else np.zeros((1, 3))
    return float(np.ptp(vertices, axis=0).max() / 2)
