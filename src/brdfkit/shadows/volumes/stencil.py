"""The stencil buffer: how many faces of volumes a ray of the camera meets before, or behind, p."""

import drjit as dr
import numpy as np

from brdfkit.shadows.volumes.tiles import faces_by_tile

RECORD = 5  # of four numbers each: four edges with their ties, the depth with how often it counts


class Stencil:
    """Counts of faces over the picture of a camera; entering adds, leaving takes away.

    faces : `SeenFaces`.
    halvings : see `faces_by_tile`.
    """

    def __init__(self, faces, halvings):
        import mitsuba as mi

        edges = np.concatenate([faces.edges, faces.ties[..., None]], axis=2)
        depth = np.column_stack([faces.inverse_depth, faces.times])
        self.records = mi.Float(np.concatenate([edges, depth[:, None]], axis=1).ravel())
        self.numbers, self.begins, tiles = faces_by_tile(faces.edges, halvings)
        self.tiles = mi.UInt32(tiles)
        dr.make_opaque(self.records, self.numbers, self.begins, self.tiles)

    @property
    def tests(self):
        """How many pairs of a face and a tile there are."""
        return len(self.numbers)

    @property
    def memory(self):
        """What the volumes take [bytes]."""
        return 4 * sum(map(len, (self.records, self.numbers, self.begins)))

    def count(self, x, y, least, most, active=True):
        """The sum (`mi.Int32`) over the faces that the ray of a place of the picture meets, with
        1/z above `least` and up to `most`."""
        import mitsuba as mi

        if not self.tests:
            return dr.zeros(mi.Int32, dr.width(x))
        tile = self.tile(x, y)
        start = dr.gather(mi.UInt32, self.begins, tile, active)
        end = dr.gather(mi.UInt32, self.begins, tile + 1, active)

        def body(index, count):
            face = RECORD * dr.gather(mi.UInt32, self.numbers, index)
            *edges, depth = (dr.gather(mi.Vector4f, self.records, face + k) for k in range(RECORD))
            inverse_depth = depth.x * x + depth.y * y + depth.z
            meets = (inverse_depth > least) & (inverse_depth <= most)
            for edge in edges:
                meets &= edge.x * x + edge.y * y + edge.z >= edge.w
            return index + 1, count + dr.select(meets, mi.Int32(depth.w), 0)

        state = start, mi.Int32(0)
        return dr.while_loop(state, lambda index, count: index < end, body)[1]

    def tile(self, x, y):
        """The number of the tile of a place; places off the picture have that of its edge."""
        import mitsuba as mi

        column, row = (mi.Int32(dr.floor((c + 1) * 0.5 * mi.Float(self.tiles))) for c in (x, y))
        last = mi.Int32(self.tiles) - 1
        column, row = dr.clip(column, 0, last), dr.clip(row, 0, last)
        return mi.UInt32(row) * self.tiles + mi.UInt32(column)
