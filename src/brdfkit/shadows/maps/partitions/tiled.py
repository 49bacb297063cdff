"""Tiled shadow maps: a grid of tiles on the light's map, which share the texels of one map by need.

[Arvo 2004] does not say how many texels each tile gets; here the expected number of wrong pixels is
minimised. Pixels are wrong along borders of shadows, and the wider the texels are in the picture.
So a tile of r × r texels has wrong pixels in proportion to Σ footprint / r, a sum over the visible
points in the tile. The footprint of a point is the width in the picture of a step on the map, by
128² camera rays. With a fixed number of texels in all tiles, Σ r² = resolution², the minimum is at

    r ∝ (Σ footprint)^(1/3)

The partition is good where few tiles are near the eye. It costs a rendering of depths for each
tile, but with as many texels in all as one map.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.mitsuba_bridge.properties.declarations import declare_int
from brdfkit.shadows.maps.cells import GUTTER, Cell, make_cell_finder
from brdfkit.shadows.maps.partition import Part, Partition, Setup
from brdfkit.shadows.maps.resolution import locate_on_map, texel_footprints
from brdfkit.shadows.maps.visible_surfaces import find_visible_surfaces

SETTINGS = {"tiles": declare_int(4, (1, 16), "tiles along a side of the map")}
LEAST_TEXELS = 4 * GUTTER  # side of the smallest tile [texels], twice the width of its gutters


def make_partition(setup: Setup, tiles: int) -> Partition:
    """Make a partition that divides the map of the whole scene into `tiles` × `tiles` squares."""
    whole = setup.project(setup.placement)
    surfaces = find_visible_surfaces(setup.scene, setup.placement.camera)
    places = locate_on_map(whole, surfaces)
    widths = texel_footprints(places, surfaces)
    weights = np.histogram2d(places[:, 1], places[:, 0], tiles, [[-1, 1]] * 2, weights=widths)[0]
    sizes = distribute_texels(weights, setup.resolution)
    parts = [
        Part(Cell.from_grid(whole, column, row, tiles, size), size)
        for row, its_sizes in enumerate(sizes.tolist())
        for column, size in enumerate(its_sizes)
    ]
    return Partition(parts, make_cell_finder(whole, np.arange(tiles**2).reshape(tiles, tiles)))


def distribute_texels(weights: FloatArray, resolution: int) -> IntArray:
    """Return the side [texels] of each tile, in proportion to the cube root of its weight.

    Together the tiles have about `resolution`² texels, but no side is below `LEAST_TEXELS`.
    """
    need = np.cbrt(weights)
    share = need / max(float(np.linalg.norm(need)), 1e-30)
    return np.maximum(LEAST_TEXELS, np.floor(share * resolution)).astype(int)
