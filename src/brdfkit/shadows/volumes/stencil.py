"""The stencil buffer: counts the faces of volumes that a camera ray meets before or behind a point.

The picture is halved again and again into tiles. Each tile has a list of the faces that may be
visible in it, so that a ray tests few faces.
"""

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.shadows.volumes.projected_faces import ProjectedFaces

RECORD = 5  # vectors of four numbers per face: four edges with their ties, depth with `times`
SLACK = 1e-5  # tiles are widened by this, so that rounded edges do not miss them
MAX_PAIRS = 2**24  # with more pairs of a face and a tile, tiles are not halved further


class Stencil:
    """Counts of faces along camera rays; entering a volume adds to a count, leaving it subtracts.

    faces : the faces in the camera's picture.
    halvings : how often the picture is halved into tiles.
    """

    def __init__(self, faces: ProjectedFaces, halvings: int) -> None:
        import mitsuba as mi

        edges = np.concatenate([faces.edges, faces.ties[..., None]], axis=2)
        depth = np.column_stack([faces.inverse_depth, faces.times])
        self.records = mi.Float(np.concatenate([edges, depth[:, None]], axis=1).ravel())
        self.indices, self.begins, tiles = list_faces_by_tile(faces.edges, halvings)
        self.tiles = mi.UInt32(tiles)
        dr.make_opaque(self.records, self.indices, self.begins, self.tiles)

    @property
    def pair_count(self) -> int:
        """The number of pairs of a face and a tile in which it may be visible."""
        return len(self.indices)

    def count_faces(
        self, x: JitFloat, y: JitFloat, least: JitFloat, most: JitFloat, active: JitMask = True
    ) -> JitInt:
        """Return the signed number (`mi.Int32`) of faces that camera rays meet: entries less exits.

        Only faces whose 1/z, z the depth, is above `least` and at most `most` count.

        x, y : the places of the rays in the picture, in [-1, 1].
        """
        import mitsuba as mi

        if not self.pair_count:
            return dr.zeros(mi.Int32, dr.width(x))
        tile = self.find_tile(x, y)
        start = dr.gather(mi.UInt32, self.begins, tile, active)
        end = dr.gather(mi.UInt32, self.begins, tile + 1, active)

        def count_next_face(index: JitInt, count: JitInt) -> tuple[JitInt, JitInt]:
            face = RECORD * dr.gather(mi.UInt32, self.indices, index)
            *edges, depth = (dr.gather(mi.Vector4f, self.records, face + k) for k in range(RECORD))
            inverse_depth = depth.x * x + depth.y * y + depth.z
            meets = (inverse_depth > least) & (inverse_depth <= most)
            for edge in edges:
                meets &= edge.x * x + edge.y * y + edge.z >= edge.w
            return index + 1, count + dr.select(meets, mi.Int32(depth.w), 0)

        state = start, mi.Int32(0)
        return dr.while_loop(state, lambda index, count: index < end, count_next_face)[1]

    def find_tile(self, x: JitFloat, y: JitFloat) -> JitInt:
        """Return the index of the tile at (x, y); places off the picture get the nearest tile."""
        import mitsuba as mi

        column, row = (mi.Int32(dr.floor((c + 1) * 0.5 * mi.Float(self.tiles))) for c in (x, y))
        last = mi.Int32(self.tiles) - 1
        column, row = dr.clip(column, 0, last), dr.clip(row, 0, last)
        return mi.UInt32(row) * self.tiles + mi.UInt32(column)


def list_faces_by_tile(edges: FloatArray, halvings: int) -> tuple[JitInt, JitInt, int]:
    """Return the faces' indices sorted by tile, where each tile's list begins, and tiles per side.

    The first two are `mi.UInt32`. The tiles of the picture [-1, 1]² are counted row by row.

    edges : (k, 4, 3), of `ProjectedFaces`.
    halvings : how often the picture is halved in both directions, unless the pairs of a face and a
        tile become too many.
    """
    import mitsuba as mi

    factors = [mi.Float(np.ascontiguousarray(edges[:, i].ravel())) for i in range(4)]
    face = dr.arange(mi.UInt32, len(edges))
    column, row = dr.zeros(mi.UInt32, len(edges)), dr.zeros(mi.UInt32, len(edges))
    for level in range(halvings + 1):
        if not len(face):
            break
        within = may_touch_tile(factors, face, column, row, dr.opaque(mi.Float, 1 / 2**level))
        indices: JitInt = dr.compress(within)
        face, column, row = (dr.gather(mi.UInt32, part, indices) for part in (face, column, row))
        if level == halvings or len(face) > MAX_PAIRS:
            break
        quarter = dr.tile(dr.arange(mi.UInt32, 4), len(face))
        face = dr.repeat(face, 4)
        column = 2 * dr.repeat(column, 4) + quarter % 2
        row = 2 * dr.repeat(row, 4) + quarter // 2
    tile = np.array(row) * 2**level + np.array(column)
    order = np.argsort(tile, kind="stable")
    begins = np.searchsorted(tile[order], np.arange(4**level + 1))
    return mi.UInt32(np.array(face)[order]), mi.UInt32(begins), 2**level


def may_touch_tile(
    factors: list[JitVector], face: JitInt, column: JitInt, row: JitInt, half: JitFloat
) -> JitMask:
    """Return whether each face may touch its tile: no edge has all of the tile on its outer side.

    factors : coefficients of x, y and 1 in the four edge functions, for all faces.
    face, column, row : the index of each face, and the place of its tile.
    half : half the width of a tile.
    """
    import mitsuba as mi

    x, y = (2 * mi.Float(place) * half + (half - 1) for place in (column, row))
    within = mi.Bool(True)
    for edge in factors:
        a, b, c = dr.gather(mi.Vector3f, edge, face)
        farthest = a * x + b * y + c + (half + SLACK) * (dr.abs(a) + dr.abs(b))
        within &= farthest >= 0
    return within
