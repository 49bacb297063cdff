"""The size of shadow-map texels in the picture: √(1/|det J|), J the Jacobian from pixels to texels.

Texels that are larger than pixels are visible [Ergun 2008, 3.1.1].
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitVector
from brdfkit.shadows.maps.projection import AnyProjection
from brdfkit.shadows.maps.visible_surfaces import SIDE, VisibleSurfaces


def texel_area_in_pixels(
    texels: tuple[AnyProjection, int], pixels: tuple[AnyProjection, Any], p: JitVector, n: JitVector
) -> JitFloat:
    """Return the area [pixels] of a shadow map's texel in the picture, at surface points.

    It is 1 / |det J|, with the Jacobian J from pixels to texels. Components are floats, NumPy
    arrays or, with projections made opaque, Dr.Jit arrays.

    texels : projection and resolution of the shadow map.
    pixels : projection by the camera's matrix, and (width, height) of the picture.
    p, n : the points and their normals.
    """
    projection, resolution = texels
    camera, (width, height) = pixels
    pixel_density = width * height * area_magnification(camera, p, n)
    return pixel_density / (resolution**2 * area_magnification(projection, p, n))


def area_magnification(projection: AnyProjection, p: JitVector, n: JitVector) -> JitFloat:
    """Return the area on a map per area of the surface at points `p` with normals `n`."""
    (u_x, v_x, _), (u_y, v_y, _), (u_z, v_z, _) = (
        projection.directional_derivative(p, way)
        for way in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )
    return abs(
        n[0] * (u_y * v_z - u_z * v_y)
        + n[1] * (u_z * v_x - u_x * v_z)
        + n[2] * (u_x * v_y - u_y * v_x)
    )


def locate_on_map(projection: AnyProjection, surfaces: VisibleSurfaces) -> FloatArray:
    """Return the map coordinates (n, 2), in [-1, 1], of visible points under a projection."""
    return np.column_stack(projection.project(*surfaces.points.T)[:2])


def texel_footprints(places: FloatArray, surfaces: VisibleSurfaces) -> FloatArray:
    """Return the width (n,) in the picture of a unit step on the map, at visible surface points.

    The unit in the picture is the distance between neighbouring rays, and the width is estimated
    from the differences between them. At borders of surfaces it is too small; it is 0 where a
    neighbour hits nothing.

    places : coordinates (n, 2) of the points on the map.
    """
    grid = np.full((SIDE, SIDE, 2), np.nan)
    grid[surfaces.hit] = places
    (u_row, v_row), (u_column, v_column) = (
        np.moveaxis(np.diff(grid, axis=axis, append=np.nan), -1, 0) for axis in (0, 1)
    )
    area = np.abs(u_row * v_column - u_column * v_row)[surfaces.hit]
    known = area > 0  # false also for NaN, where a neighbouring ray hits nothing
    return np.where(known, 1 / np.sqrt(np.where(known, area, 1)), 0)
