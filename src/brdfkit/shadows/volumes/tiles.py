"""Which faces may be seen in which tile of a picture, by halving it again and again."""

import drjit as dr
import numpy as np

SLACK = 1e-5  # of the picture's size: beyond the rounding of the edges
MOST = 2**24  # pairs of a face and a tile, from which on tiles stay as they are


def faces_by_tile(edges, halvings):
    """(The numbers of faces, tile by tile; where each tile's begin; tiles along a side).

    The first two are `mi.UInt32`; the picture [-1, 1]² has its tiles row by row.

    edges : (k, 4, 3), of `SeenFaces`.
    halvings : how often the picture is halved, both ways, unless the pairs become too many.
    """
    import mitsuba as mi

    factors = [mi.Float(np.ascontiguousarray(edges[:, i].ravel())) for i in range(4)]
    face = dr.arange(mi.UInt32, len(edges))
    column, row = dr.zeros(mi.UInt32, len(edges)), dr.zeros(mi.UInt32, len(edges))
    for level in range(halvings + 1):
        if not len(face):
            break
        within = may_be_in(factors, face, column, row, dr.opaque(mi.Float, 1 / 2**level))
        kept = dr.compress(within)
        face, column, row = (dr.gather(mi.UInt32, part, kept) for part in (face, column, row))
        if level == halvings or len(face) > MOST:
            break
        quarter = dr.tile(dr.arange(mi.UInt32, 4), len(face))
        face = dr.repeat(face, 4)
        column = 2 * dr.repeat(column, 4) + quarter % 2
        row = 2 * dr.repeat(row, 4) + quarter // 2
    tile = np.array(row) * 2**level + np.array(column)
    order = np.argsort(tile, kind="stable")
    begins = np.searchsorted(tile[order], np.arange(4**level + 1))
    return mi.UInt32(np.array(face)[order]), mi.UInt32(begins), 2**level


def may_be_in(factors, face, column, row, half):
    """Whether faces touch tiles of twice the width `half`: no edge has all of a tile beyond it."""
    import mitsuba as mi

    x, y = (2 * mi.Float(place) * half + (half - 1) for place in (column, row))
    within = mi.Bool(True)
    for edge in factors:
        a, b, c = dr.gather(mi.Vector3f, edge, face)
        farthest = a * x + b * y + c + (half + SLACK) * (dr.abs(a) + dr.abs(b))
        within &= farthest >= 0
    return within
