"""The size of a map's texels in the picture: √(1/|det J|), with the Jacobian J from pixels to map.

Texels that are larger than pixels are visible [Ergun 2008, 3.1.1].
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitVector
from brdfkit.shadows.maps.projection import AnyProjection
from brdfkit.shadows.maps.visible_surfaces import SIDE, VisibleSurfaces


def aliasing(
    texels: tuple[AnyProjection, int], pixels: tuple[AnyProjection, Any], p: JitVector, n: JitVector
) -> JitFloat:
    """Return 1 / |det J|, a texel's area in pixels, at a surface point `p` with normal `n`.

    texels : of the shadow map, its projection and resolution.
    pixels : of the picture, a projection by its camera's matrix, and its width and height.

    Components are floats, NumPy arrays or, of opaque projections, Dr.Jit arrays.
    """
    projection, resolution = texels
    camera, (width, height) = pixels
    pixel_density = width * height * magnification(camera, p, n)
    return pixel_density / (resolution**2 * magnification(projection, p, n))


def magnification(projection: AnyProjection, p: JitVector, n: JitVector) -> JitFloat:
    """Return the area on the map's square per area on a surface at `p` with the normal `n`."""
    (u_x, v_x, _), (u_y, v_y, _), (u_z, v_z, _) = (
        projection.derivative_along(p, way)
        for way in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )
    return abs(
        n[0] * (u_y * v_z - u_z * v_y)
        + n[1] * (u_z * v_x - u_x * v_z)
        + n[2] * (u_x * v_y - u_y * v_x)
    )


def places_on_map(projection: AnyProjection, surfaces: VisibleSurfaces) -> FloatArray:
    """Return the places (n, 2) of visible points on a projection's map, in [-1, 1]²."""
    return np.column_stack(projection.to_map(*surfaces.points.T)[:2])


def footprints(places: FloatArray, surfaces: VisibleSurfaces) -> FloatArray:
    """Return how wide (n,) a step of 1 on the map is in the picture, at `places` (n, 2) of the map.

    The unit of width is the distance between neighbouring rays, whose differences give the widths.
    At borders of surfaces widths are too small; a width is 0 where a neighbour hits nothing.
    """
    grid = np.full((SIDE, SIDE, 2), np.nan)
    grid[surfaces.hit] = places
    (u_row, v_row), (u_column, v_column) = (
        np.moveaxis(np.diff(grid, axis=axis, append=np.nan), -1, 0) for axis in (0, 1)
    )
    area = np.abs(u_row * v_column - u_column * v_row)[surfaces.hit]
    known = area > 0  # this is false for NaN
    return np.where(known, 1 / np.sqrt(np.where(known, area, 1)), 0)
