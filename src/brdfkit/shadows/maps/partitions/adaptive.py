"""Adaptive shadow maps: a quadtree of maps, finest where the camera sees borders of shadows (ASM).

At first the light's map is a single square. Again and again, the square with the largest expected
number of wrong pixels is divided into four, each with a map of the full resolution, until there are
as many maps as the setting `budget` allows. The expected number of wrong pixels in a square is

    Σ footprint × side

The sum is over the visible points in the square that lie at the border of a shadow. The side is the
square's, and the footprint is the width in the picture of a step on the map, see `resolution.py`.
The points are the hits of 128² camera rays. A point lies at a border if it is lit and a neighbour
is not, or the reverse. [Fernando et al. 2001] find borders on the map instead, and also consider
the gain per texel.

The partition is best where few borders are visible. It costs a rendering of the map for each
square, and first shadow rays: too slow for games, as [Ergun 2008, 2.2.3.1] says.
"""

import heapq
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.mitsuba_bridge.properties.declarations import declare_int
from brdfkit.shadows.maps.cells import Cell, make_cell_finder
from brdfkit.shadows.maps.partition import Part, Partition, Setup
from brdfkit.shadows.maps.resolution import locate_on_map, texel_footprints
from brdfkit.shadows.maps.visible_surfaces import VisibleSurfaces, find_visible_surfaces, is_lit

SETTINGS = {"budget": declare_int(16, (1, 256), "maps at most, of the full resolution each")}
MAX_LEVEL = 7  # largest level of a square: how often the whole map is divided to reach it
Leaf: TypeAlias = tuple[int, int, int]  # level, row and column of a square


def make_partition(setup: Setup, budget: int) -> Partition:
    """Make a partition that divides the map of the whole scene into at most `budget` squares."""
    scene, light, resolution = setup.scene, setup.placement.light, setup.resolution
    whole = setup.project(setup.placement)
    surfaces = find_visible_surfaces(scene, setup.placement.camera)
    places = locate_on_map(whole, surfaces)
    border = is_at_shadow_border(surfaces, is_lit(scene, light, surfaces))
    leaves = grow_quadtree(places[border], texel_footprints(places, surfaces)[border], budget)
    parts = [
        Part(Cell.from_grid(whole, column, row, 2**level, resolution), resolution)
        for level, row, column in leaves
    ]
    return Partition(parts, make_cell_finder(whole, make_leaf_table(leaves)))


def is_at_shadow_border(surfaces: VisibleSurfaces, lit: BoolArray) -> BoolArray:
    """Return whether a border of a shadow runs between each visible point and a neighbour, (n,).

    The neighbours are the points of the next row and column of camera rays.

    lit : whether the light reaches each visible point, (n,).
    """
    grid = np.full(surfaces.hit.shape, np.nan)
    grid[surfaces.hit] = lit
    below, beside = (np.abs(np.diff(grid, axis=axis, append=np.nan)) == 1 for axis in (0, 1))
    border: BoolArray = (below | beside)[surfaces.hit]
    return border


def grow_quadtree(places: FloatArray, weights: FloatArray, budget: int) -> list[Leaf]:
    """Return the leaves of a quadtree over [-1, 1]² whose heaviest leaf is divided repeatedly.

    The weight of a leaf is the sum of the `weights` of the points in it, times its side.

    places, weights : coordinates (n, 2) and weights (n,) of the points.
    budget : largest number of leaves.
    """
    index = np.clip((places + 1) / 2 * 2**MAX_LEVEL, 0, 2**MAX_LEVEL - 1).astype(int)
    columns, rows = index.T

    def make_heap_entry(level: int, row: int, column: int) -> tuple[float, Leaf]:
        shift = MAX_LEVEL - level
        within = (rows >> shift == row) & (columns >> shift == column)
        weight = weights[within].sum() / 2**level if level < MAX_LEVEL else 0
        return -weight, (level, row, column)

    heap: list[Any] = [make_heap_entry(0, 0, 0)]
    while len(heap) + 3 <= budget and heap[0][0] < 0:
        _, (level, row, column) = heapq.heappop(heap)
        for i, j in np.ndindex(2, 2):
            heapq.heappush(heap, make_heap_entry(level + 1, 2 * row + i, 2 * column + j))
    return sorted(leaf for _, leaf in heap)


def make_leaf_table(leaves: list[Leaf]) -> IntArray:
    """Return which leaf covers each square of a regular grid: its index, (n, n), [row, column].

    The squares of the grid are as small as the smallest leaf.
    """
    finest = max(level for level, _, _ in leaves)
    table = np.empty((2**finest, 2**finest), int)
    for i, (level, row, column) in enumerate(leaves):
        width = 2 ** (finest - level)
        table[row * width : (row + 1) * width, column * width : (column + 1) * width] = i
    return table
