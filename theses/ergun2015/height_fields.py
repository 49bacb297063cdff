"""Defines occluders that rival convex parts: a tree over height fields, RBVH.

In the tree over the triangles of [Novák & Dachsbacher 2012], a node whose triangles all face to one
side becomes a height field over the plane that they face, in which a ray marches from texel to
texel. The original keeps triangles where a field would hold few of them; here every leaf is a
field.
"""

import numpy as np

from brdfkit.lighting.visibility.hierarchy import Hierarchy
from brdfkit.lighting.visibility.hull import Frames
from brdfkit.lighting.visibility.occluders import CLEARANCE
from brdfkit.mitsuba_bridge.arrays import Rows, find_cell

SIDE = 32  # texels
MAX_TRIANGLES = 512  # the most in a field: about the number of its texels
MIN_COS = 0.3  # the least cosine between a triangle's normal and its field's heights
NO_SURFACE = -1e3  # the height of an empty texel, far below a field's heights of 0 to 1
MARGIN = 0.02  # the space in a field's box around its heights, over its largest side


class HeightFields:
    """The height fields of a mesh, and a tree over them, which answer rays as `Occluders` do.

    points, faces : the vertices (n, 3) of the mesh, and the vertex numbers (m, 3) of its triangles.
    clearance : the distance within which a field does not block a ray, over half of the mesh's
        side.
    """

    def __init__(self, points, faces, clearance=CLEARANCE):
        self.clearance = clearance * np.ptp(points, axis=0).max() / 2
        corners = np.asarray(points, float)[faces]
        groups = group_one_sided_triangles(corners)
        fields = [_make_field(corners[group]) for group in groups]
        boxes = [
            (corners[group].min(axis=(0, 1)), corners[group].max(axis=(0, 1))) for group in groups
        ]
        self.tree = Hierarchy(*(np.array(side) for side in zip(*boxes, strict=True)))
        self.frames = Frames([to_field for to_field, _ in fields])
        self.heights = Rows(np.concatenate([heights.ravel() for _, heights in fields]))

    def is_blocked(self, ray, active=True):
        """Return whether a field lies before the ray's `maxt`, and the reads of heights."""
        return self.tree.find_any_hit(ray, lambda field, a: self._march(ray, field, a), active)

    def _march(self, ray, field, active):
        """Return whether the ray crosses a field, and how many heights it reads."""
        import drjit as dr
        import mitsuba as mi

        # Transform the ray to the field's frame, whose box is the unit cube, and clip it there
        o, d = self.frames.transform_ray(field, ray, active)
        inverse = dr.rcp(d)
        a, b = -o * inverse, (1 - o) * inverse
        near = dr.maximum(dr.max(dr.minimum(a, b)), self.clearance)
        far = dr.minimum(dr.min(dr.maximum(a, b)), ray.maxt)

        # Steps are at most a texel long; the ray crosses the field where it changes sides
        length = dr.maximum(far - near, 0) * SIDE * dr.maximum(dr.abs(d.x), dr.abs(d.y))
        steps = dr.select(active & (near < far), mi.UInt32(dr.ceil(length)) + 1, 0)
        step = (far - near) / dr.maximum(mi.Float(steps), 1)

        def read(i, before, hit):
            p = o + (near + (mi.Float(i) + 0.5) * step) * d
            x, y = (find_cell(c * SIDE, SIDE) for c in (p.x, p.y))
            height = self.heights.at((field * SIDE + y) * SIDE + x, active=active)
            above = dr.select(height < 0, 0, dr.sign(p.z - height))
            crossed = above * before < 0
            return i + 1, above, dr.select(crossed, mi.UInt32(1), mi.UInt32(0))

        reads, _, hit = dr.while_loop(
            (mi.UInt32(0), mi.Float(0), mi.UInt32(0)),
            lambda i, before, hit: (i < steps) & (hit == 0),
            read,
        )
        return hit == 1, reads


def group_one_sided_triangles(corners):
    """Return the numbers of the triangles `corners` (m, 3, 3) of each field, as a list of arrays.

    A group is halved along the longest side of its box until all of it faces one direction.
    """
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    units = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    centres = corners.mean(axis=1)
    waiting, groups = [np.flatnonzero(np.linalg.norm(normals, axis=1) > 0)], []
    while waiting:
        group = waiting.pop()
        up = normals[group].sum(axis=0)
        up = up / max(np.linalg.norm(up), 1e-30)
        one_sided = len(group) == 1 or (units[group] @ up).min() > MIN_COS
        if one_sided and len(group) <= MAX_TRIANGLES:
            groups.append(group)
            continue
        axis = np.ptp(centres[group], axis=0).argmax()
        order = group[centres[group, axis].argsort(kind="stable")]
        waiting += [order[: len(order) // 2], order[len(order) // 2 :]]
    return groups


def _make_field(corners):
    """Return the map (3, 4) to a field's unit cube, and its heights (SIDE, SIDE).

    The field is of triangles (m, 3, 3). The heights are along z, rows along y and columns along x.
    """
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
    z = normal / np.linalg.norm(normal)
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    x /= np.linalg.norm(x)
    axes = np.stack([x, np.cross(z, x), z])
    local = corners @ axes.T
    low, high = local.min(axis=(0, 1)), local.max(axis=(0, 1))
    room = MARGIN * (high - low).max()
    size = high - low + 2 * room
    to_field = np.column_stack([axes, room - low]) / size[:, None]
    return to_field, rasterise_heights((local - low + room) / size)


def rasterise_heights(corners):
    """Return the greatest height z of triangles (m, 3, 3) in the unit cube at each texel's centre.

    The result (SIDE, SIDE) is `NO_SURFACE` where there is no triangle.
    """
    centres = (np.arange(SIDE) + 0.5) / SIDE
    y, x = np.meshgrid(centres, centres, indexing="ij")
    heights = np.full((SIDE, SIDE), NO_SURFACE)
    for a, b, c in corners:
        # The barycentric coordinates v and w of a texel are ≥ 0 within the triangle
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if abs(area) < 1e-12:
            continue
        v = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area
        w = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area
        inside = (v >= -1e-9) & (w >= -1e-9) & (v + w <= 1 + 1e-9)
        height = a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2])
        heights = np.where(inside, np.maximum(heights, height), heights)
    return heights
