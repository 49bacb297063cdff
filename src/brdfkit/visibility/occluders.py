"""Objects of convex parts, which can be moved, and the rays that they block."""

import numpy as np

from brdfkit.errors import BrdfkitError, no_such
from brdfkit.host.arrays import Rows
from brdfkit.visibility.convex_ray import enter
from brdfkit.visibility.hierarchy import END, ROOT, Hierarchy, after
from brdfkit.visibility.plane_map import RasterisedPlaneMap

RESOLUTION = 64


class Occluders:
    """The convex parts of objects, their plane maps, and a tree over the parts of all objects.

    objects : name → list of its parts, `Hull`s; at least one part in all.
    resolution : side of the plane map of the largest part, in texels.

    An object that is moved changes its transform and the tree; its plane maps stay as they are.
    """

    def __init__(self, objects, resolution=RESOLUTION):
        self.hulls = [hull for parts in objects.values() for hull in parts]
        if not self.hulls:
            raise BrdfkitError("There are no convex parts; give an object that encloses a volume.")
        ends = np.cumsum([len(parts) for parts in objects.values()])
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
        self.to_unit = Rows((to_unit @ np.linalg.inv(self._to_world)).reshape(-1, 4))

    def blocked(self, ray, active=True):
        """(whether a part lies between the ray's origin and its `maxt`, look-ups in plane maps).

        A part that holds the origin does not block: the origin lies on the surface within it.
        """
        import drjit as dr
        import mitsuba as mi

        inverse = dr.rcp(ray.d)

        def test(node, blocked, lookups):
            leaf, part = self.tree.next_leaf(node, ray, inverse)
            found = leaf != END
            t, entered, count = self._enter(ray, part, found)
            hit = entered & (t >= 0) & (t < ray.maxt)
            onward = dr.select(found, after(leaf), END)
            return onward, dr.select(hit, mi.UInt32(1), mi.UInt32(0)), lookups + count

        with dr.suspend_grad():  # shadows have edges, which such a test has no derivative of
            _, blocked, lookups = dr.while_loop(
                (dr.select(active, mi.UInt32(ROOT), mi.UInt32(END)), mi.UInt32(0), mi.UInt32(0)),
                lambda node, blocked, lookups: (node != END) & (blocked == 0),
                test,
            )
        return blocked == 1, lookups

    def _enter(self, ray, part, active):
        """Where the ray enters a part, in the ray's own unit of distance; see `enter`."""
        import drjit as dr
        import mitsuba as mi

        rows = [self.to_unit.at(3 * part + k, mi.Vector4f, active) for k in range(3)]
        linear = [mi.Vector3f(row.x, row.y, row.z) for row in rows]
        o = mi.Point3f(*(dr.dot(a, ray.o) + row.w for a, row in zip(linear, rows, strict=True)))
        d = mi.Vector3f(*(dr.dot(a, ray.d) for a in linear))
        length = dr.select(active, dr.norm(d), 1)
        t, entered, count = enter(mi, o, d / length, self.maps, part, active)
        return t / length, entered, count
