"""Objects of convex parts, which can be moved, and the rays that they block."""

import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.lighting.visibility.convex_ray import enter
from brdfkit.lighting.visibility.hierarchy import Hierarchy
from brdfkit.lighting.visibility.hull import Frames
from brdfkit.lighting.visibility.plane_map import RasterisedPlaneMap
from brdfkit.mitsuba_bridge.arrays import Rows

RESOLUTION = 128  # texels
CLEARANCE = 0.03  # over half of the longest side of an object: as far as hulls bulge by default


class Occluders:
    """The convex parts of objects, their plane maps, and a tree over the parts of all objects.

    objects : name → list of its parts, `Hull`s; at least one part in all.
    resolution : side of the plane map of the largest part, in texels.
    clearance : a part that a ray enters nearer than this does not block it, as a share of half the
        longest side of its object's bounding box.

    A hull bulges out of the mesh where that is hollow, and would shade the mesh beside it: without
    the clearance, dark lines follow the seams between the parts.

    An object that is moved changes its transform and the tree; its plane maps stay as they are.
    """

    def __init__(self, objects, resolution=RESOLUTION, clearance=CLEARANCE):
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
        self.clearance = Rows(np.repeat([clearance * _half(p) for p in objects.values()], lengths))
        self._update()

    def move(self, name, to_world):
        """Place the object `name` by a matrix (4, 4), from its first place to its new one.

        Raises `BrdfkitError` for an unknown object, and for a matrix that cannot be inverted.
        """
        if name not in self._parts:
            raise no_such("object", name, self._parts)
        matrix = np.asarray(to_world, float)
        if matrix.shape != (4, 4) or not abs(np.linalg.det(matrix)) > 0:
            raise BrdfkitError(f"{name}: to_world should be an invertible matrix (4, 4).")
        self._to_world[self._parts[name]] = matrix
        self._update()

    def _update(self):
        """Compute what depends on where the objects are."""
        world = self._to_world[self._vertex_part]
        placed = np.einsum("nij,nj->ni", world[:, :3, :3], self._vertices) + world[:, :3, 3]
        low = np.minimum.reduceat(placed, self._starts)
        high = np.maximum.reduceat(placed, self._starts)
        self.tree = Hierarchy(low, high)
        to_unit = np.stack([hull.to_unit for hull in self.hulls])
        self.frames = Frames(to_unit @ np.linalg.inv(self._to_world))

    def blocked(self, ray, active=True):
        """(whether a part lies between the ray's origin and its `maxt`, look-ups in plane maps).

        A part that holds the origin does not block: the origin lies on the surface within it.
        """

        def test(part, active):
            t, entered, reads = self._enter(ray, part, active)
            return entered & (t >= self.clearance.at(part, active=active)) & (t < ray.maxt), reads

        return self.tree.any_hit(ray, test, active)

    def _enter(self, ray, part, active):
        """Where the ray enters a part, in the ray's own unit of distance; see `enter`."""
        import drjit as dr
        import mitsuba as mi

        o, d = self.frames.ray(part, ray, active)
        length = dr.select(active, dr.norm(d), 1)
        t, entered, count = enter(mi, o, d / length, self.maps, part, active)
        return t / length, entered, count


def _half(parts):
    """Half of the longest side of the bounding box of an object's parts; 0 where it has none."""
    vertices = np.concatenate([hull.vertices for hull in parts]) if parts else np.zeros((1, 3))
    return np.ptp(vertices, axis=0).max() / 2
