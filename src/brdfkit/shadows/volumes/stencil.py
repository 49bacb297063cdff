"""`Stencil`: counts the faces of shadow volumes that a camera ray meets before or behind a point.

The name is that of the stencil buffer with which graphics hardware counts. The picture is divided
into tiles, by halving it repeatedly. Each tile has a list of the faces that may be visible in it,
so that a ray tests few faces.
"""

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.shadows.volumes.projected_faces import ProjectedFaces

# Number of vectors with four components that store a face: its four edge functions, each with its
# tie, and the function of inverse depth, with `times` of `ProjectedFaces`
RECORD = 5
SLACK = 1e-5  # width by which tiles are enlarged, so that rounding errors do not lose a face
MAX_PAIRS = 2**24  # number of pairs of a face and a tile above which tiles are not halved again


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
        """The number of pairs of a face and a tile in which the face may be visible."""
        return len(self.indices)

    def count_faces(
        self, x: JitFloat, y: JitFloat, least: JitFloat, most: JitFloat, active: JitMask = True
    ) -> JitInt:
        """Count the faces that camera rays meet: how many volumes they enter less those they leave.

        x, y : the places of the rays in the picture, in [-1, 1].
        least, most : faces count if their inverse depth 1/z is above `least` and at most `most`.
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
        """Return the index of the tile at (x, y), or of the nearest tile for a place outside."""
        import mitsuba as mi

        column, row = (mi.Int32(dr.floor((c + 1) * 0.5 * mi.Float(self.tiles))) for c in (x, y))
        last = mi.Int32(self.tiles) - 1
        column, row = dr.clip(column, 0, last), dr.clip(row, 0, last)
        return mi.UInt32(row) * self.tiles + mi.UInt32(column)


def list_faces_by_tile(edges: FloatArray, halvings: int) -> tuple[JitInt, JitInt, int]:
    """List the faces that may be visible in each tile of the picture [-1, 1]².

    Return the faces' indices, sorted by tile; the place at which the list of each tile begins; and
    the number of tiles per side. Tiles are counted row by row.

    edges : coefficients of the edge functions (k, 4, 3), of `ProjectedFaces`.
    halvings : how often the picture is halved in both directions, unless there are too many pairs
        of a face and a tile.
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
    """Return for pairs of a face and a tile whether the face may be visible in the tile.

    It may be unless the tile is all on the outer side of one of the face's edges.

    factors : coefficients of x, y and 1 in the four edge functions, for all faces.
    face, column, row : for each pair, the index of the face, and the column and row of the tile.
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
