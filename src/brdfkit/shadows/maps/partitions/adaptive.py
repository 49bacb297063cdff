"""A tree of squares of the light's map, finest where the camera sees borders of shadows (ASM).

The map is a square; the square that has the most wrong pixels to expect becomes four, each with a
map as large as its own was, until the `budget` of maps is spent. To be expected are

    Σ footprint × side,   over the points in a square that lie at a border

with the footprint √(1/|det J|) of a texel in the picture. Borders are where a ray to the light goes
through and that of a neighbour does not, of 128² rays of the camera. [Fernando et al. 2001] find
them on the map, and refine by what is gained for a texel, too.

Best where few borders are seen. A pass a square, and rays of shadow before; too slow for games, as
[Ergun 2008, 2.2.3.1] says.
"""

import heapq

import numpy as np

from brdfkit.mitsuba_bridge.properties.declarations import count
from brdfkit.shadows.maps.cells import Cell, by_cell
from brdfkit.shadows.maps.partition import Part, Partition
from brdfkit.shadows.maps.resolution import footprints, on_map
from brdfkit.shadows.maps.seen_surfaces import lit, seen_surfaces

SETTINGS = {"budget": count(16, (1, 256), "maps at most, of the full resolution each")}
DEEPEST = 7  # times that a square may be cut


def partition(scene, placement, project, resolution, budget):
    whole = project(placement)
    seen = seen_surfaces(scene, placement.camera)
    places = on_map(whole, seen)
    border = at_borders(seen, lit(scene, placement.light, seen))
    leaves = tree(places[border], footprints(places, seen)[border], budget)
    parts = [
        Part(Cell.of_grid(whole, column, row, 2**level, resolution), resolution)
        for level, row, column in leaves
    ]
    return Partition(parts, by_cell(whole, table_of(leaves)))


def at_borders(seen, is_lit):
    """Which points (n,) of a `SeenSurfaces` are lit unlike the next in their row or column."""
    grid = np.full(seen.hit.shape, np.nan)
    grid[seen.hit] = is_lit
    below, beside = (np.abs(np.diff(grid, axis=axis, append=np.nan)) == 1 for axis in (0, 1))
    return (below | beside)[seen.hit]


def tree(places, weights, budget):
    """The leaves (level, row, column) of the tree over [-1, 1]² whose greatest leaf is cut next.

    A leaf is as great as the sum of the `weights` (n,) of its `places` (n, 2), times its side.
    """
    number = np.clip((places + 1) / 2 * 2**DEEPEST, 0, 2**DEEPEST - 1).astype(int)
    columns, rows = number.T

    def leaf(level, row, column):
        shift = DEEPEST - level
        within = (rows >> shift == row) & (columns >> shift == column)
        greatness = weights[within].sum() / 2**level if level < DEEPEST else 0
        return -greatness, (level, row, column)

    heap = [leaf(0, 0, 0)]
    while len(heap) + 3 <= budget and heap[0][0] < 0:
        _, (level, row, column) = heapq.heappop(heap)
        for i, j in np.ndindex(2, 2):
            heapq.heappush(heap, leaf(level + 1, 2 * row + i, 2 * column + j))
    return sorted(found for _, found in heap)


def table_of(leaves):
    """The numbers of the `leaves` that cover each square (n, n) of the finest level."""
    deepest = max(level for level, _, _ in leaves)
    table = np.empty((2**deepest, 2**deepest), int)
    for i, (level, row, column) in enumerate(leaves):
        width = 2 ** (deepest - level)
        table[row * width : (row + 1) * width, column * width : (column + 1) * width] = i
    return table
