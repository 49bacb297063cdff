"""A grid of tiles on the light's map that share the texels of one map by need (tiled shadow maps).

As [Arvo 2004], who leaves the weights open; ours make the expected count of wrong pixels least. A
tile of r × r texels has wrong pixels along borders, as many as its texels are wide in the picture:
a sum over its points of footprint / r. The least sum over all tiles, of Σ r² = resolution², has

    r ∝ (Σ footprints)^(1/3)

Footprints are those of 128² rays of the camera. Good where few tiles are near the eye; costs a pass
a tile, of the same texels in all.
"""

import numpy as np

from brdfkit.mitsuba_bridge.properties.declarations import count
from brdfkit.shadows.maps.cells import GUTTER, Cell, by_cell
from brdfkit.shadows.maps.partition import Part, Partition
from brdfkit.shadows.maps.resolution import footprints, on_map
from brdfkit.shadows.maps.seen_surfaces import seen_surfaces

SETTINGS = {"tiles": count(4, (1, 16), "tiles along a side of the map")}
LEAST = 4 * GUTTER  # texels along a side of a tile in which no ray saw anything


def partition(scene, placement, project, resolution, tiles):
    whole = project(placement)
    seen = seen_surfaces(scene, placement.camera)
    places = on_map(whole, seen)
    weights = np.histogram2d(
        places[:, 1], places[:, 0], tiles, [[-1, 1]] * 2, weights=footprints(places, seen)
    )[0]
    sizes = shared_out(weights, resolution)
    parts = [
        Part(Cell.of_grid(whole, column, row, tiles, size), size)
        for row, its_sizes in enumerate(sizes.tolist())
        for column, size in enumerate(its_sizes)
    ]
    return Partition(parts, by_cell(whole, np.arange(tiles**2).reshape(tiles, tiles)))


def shared_out(weights, resolution):
    """The texels along the sides of tiles, of together `resolution`², by the cube roots of their
    `weights`; no tile has less than `LEAST`, so that small maps may have more in all."""
    need = np.cbrt(weights)
    share = need / max(np.linalg.norm(need), 1e-30)
    return np.maximum(LEAST, np.floor(share * resolution)).astype(int)
