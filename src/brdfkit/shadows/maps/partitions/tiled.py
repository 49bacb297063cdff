"""A grid of tiles on the light's map that share the texels of one map by need (tiled shadow maps).

[Arvo 2004] leaves the tiles' weights open; here they minimise the expected number of wrong pixels.
A tile of r × r texels has wrong pixels along borders of shadows, as many as its texels are wide in
the picture: the sum of footprint / r over its points. The least sum over all tiles, with Σ r² =
resolution², has

    r ∝ (Σ footprints)^(1/3)

The footprint of a point is the width in the picture of a step on the map, by 128² camera rays. The
partition is good where few tiles are near the eye. It costs a pass for each tile, with the same
number of texels in all.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.mitsuba_bridge.properties.declarations import declare_int
from brdfkit.shadows.maps.cells import GUTTER, Cell, make_cell_finder
from brdfkit.shadows.maps.partition import Part, Partition, Setup
from brdfkit.shadows.maps.resolution import locate_on_map, texel_footprints
from brdfkit.shadows.maps.visible_surfaces import find_visible_surfaces

SETTINGS = {"tiles": declare_int(4, (1, 16), "tiles along a side of the map")}
LEAST_TEXELS = 4 * GUTTER  # texels along a side of the smallest tile; room for its two gutters


def make_partition(setup: Setup, tiles: int) -> Partition:
    """Make a partition of `tiles` × `tiles` squares of the map of the whole scene."""
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
    """Return the number of texels along a side of each tile, by the cube roots of their `weights`.

    Together the tiles have about `resolution`² texels, but no tile has fewer than `LEAST_TEXELS`
    along a side.
    """
    need = np.cbrt(weights)
    share = need / max(float(np.linalg.norm(need)), 1e-30)
    return np.maximum(LEAST_TEXELS, np.floor(share * resolution)).astype(int)
