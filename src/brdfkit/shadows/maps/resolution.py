"""Measures how large the texels of a shadow map are in the camera's picture.

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
    """Return the area [pixels] that a shadow map's texel has in the picture, at surface points.

    texels : the projection of the shadow map, and the number of texels along its side.
    pixels : the projection by the camera's matrix, and (width, height) of the picture.
    p, n : the points and their normals; each component is a float, a NumPy array or, with opaque
        projections (`make_opaque`), a Dr.Jit array.
    """
    projection, resolution = texels
    camera, (width, height) = pixels
    pixel_density = width * height * area_magnification(camera, p, n)
    return pixel_density / (resolution**2 * area_magnification(projection, p, n))


def area_magnification(projection: AnyProjection, p: JitVector, n: JitVector) -> JitFloat:
    """Return the ratio of an area on a map to the area on a surface, at points `p`, normals `n`."""
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
    """Return the map coordinates (n, 2), in [-1, 1], of the visible surface points."""
    return np.column_stack(projection.project(*surfaces.points.T)[:2])


def texel_footprints(places: FloatArray, surfaces: VisibleSurfaces) -> FloatArray:
    """Return the footprint (n,) at visible points: the width in the picture of a step on the map.

    The step is 1 in map coordinates, and the unit of the width is the distance between neighbouring
    camera rays. The footprint is estimated from the map coordinates of neighbouring rays, so it is
    too small at borders of surfaces, and 0 where a neighbouring ray hits nothing.

    places : map coordinates (n, 2) of the points.
    """
    grid = np.full((SIDE, SIDE, 2), np.nan)
    grid[surfaces.hit] = places
    (u_row, v_row), (u_column, v_column) = (
        np.moveaxis(np.diff(grid, axis=axis, append=np.nan), -1, 0) for axis in (0, 1)
    )
    area = np.abs(u_row * v_column - u_column * v_row)[surfaces.hit]
    known = area > 0  # False where the area is NaN, as a neighbouring ray hits nothing
    return np.where(known, 1 / np.sqrt(np.where(known, area, 1)), 0)
