"""How large a map's texels are in the picture: √(1/|det J|), with J from pixels to the map.

[Ergun 2008, 3.1.1]: where they are larger than pixels, one sees them.
"""

import numpy as np

from brdfkit.shadows.maps.seen_surfaces import SIDE


def on_map(projection, seen):
    """The places (n, 2) on a projection's map, in [-1, 1]², of the points of a `SeenSurfaces`."""
    return np.column_stack(projection.to_map(*seen.points.T)[:2])


def footprints(places, seen):
    """The widths (n,) in the picture's rays of a step of 1 at `places` (n, 2) of the map.

    By differences between neighbouring rays; at borders of surfaces these are too large and the
    widths too small, and 0 where a neighbour hits nothing.
    """
    grid = np.full((SIDE, SIDE, 2), np.nan)
    grid[seen.hit] = places
    (u_row, v_row), (u_column, v_column) = (
        np.moveaxis(np.diff(grid, axis=axis, append=np.nan), -1, 0) for axis in (0, 1)
    )
    area = np.abs(u_row * v_column - u_column * v_row)[seen.hit]
    known = area > 0  # not where it is not a number, either
    return np.where(known, 1 / np.sqrt(np.where(known, area, 1)), 0)
