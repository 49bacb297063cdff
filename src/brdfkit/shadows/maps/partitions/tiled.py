"""A grid of tiles on the light's map that share the texels of one map by need (tiled shadow maps).

[Arvo 2004] leaves the tiles' weights open; ours minimise the expected number of wrong pixels. A
tile of r × r texels has wrong pixels along borders, as many as its texels are wide in the picture:
a sum over its points of footprint / r. The least sum over all tiles, with Σ r² = resolution², has

    r ∝ (Σ footprints)^(1/3)

The footprints of texels in the picture are those of 128² camera rays. Good where few tiles are near
the eye; costs a pass for each tile, with the same number of texels in all.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.mitsuba_bridge.properties.declarations import declare_int
from brdfkit.shadows.maps.cells import GUTTER, Cell, make_cell_finder
from brdfkit.shadows.maps.partition import Part, Partition, Setup
from brdfkit.shadows.maps.resolution import footprints, places_on_map
from brdfkit.shadows.maps.visible_surfaces import find_visible_surfaces

SETTINGS = {"tiles": declare_int(4, (1, 16), "tiles along a side of the map")}
LEAST_TEXELS = 4 * GUTTER  # along a side of a tile in which no ray hit a surface


def make_partition(setup: Setup, tiles: int) -> Partition:
    """Make a partition of `tiles` × `tiles` squares of the map of the whole scene."""
    whole = setup.project(setup.placement)
    surfaces = find_visible_surfaces(setup.scene, setup.placement.camera)
    places = places_on_map(whole, surfaces)
    widths = footprints(places, surfaces)
    weights = np.histogram2d(places[:, 1], places[:, 0], tiles, [[-1, 1]] * 2, weights=widths)[0]
    sizes = share_texels(weights, setup.resolution)
    parts = [
        Part(Cell.from_grid(whole, column, row, tiles, size), size)
        for row, its_sizes in enumerate(sizes.tolist())
        for column, size in enumerate(its_sizes)
    ]
    return Partition(parts, make_cell_finder(whole, np.arange(tiles**2).reshape(tiles, tiles)))


def share_texels(weights: FloatArray, resolution: int) -> IntArray:
    """Return the texels along the sides of tiles, by the cube roots of their `weights`.

    Together they have `resolution`² texels. No tile has less than `LEAST_TEXELS` along a side, so
    that small maps may have more in all.
    """
    need = np.cbrt(weights)
    share = need / max(float(np.linalg.norm(need)), 1e-30)
    return np.maximum(LEAST_TEXELS, np.floor(share * resolution)).astype(int)
