"""How large a map's texels are in the picture: √(1/|det J|), with J from pixels to the map.

[Ergun 2008, 3.1.1]: where they are larger than pixels, one sees them.
"""

import numpy as np

from brdfkit.shadows.maps.seen_surfaces import SIDE


def depth_curve(projection, corners, count=1000, seed=0):
    """How far light has come (count,), and its depth on the map (count,), at random points.

    projection : a `Projection`.
    corners : (n, 3), of the convex body that has the points.
    """
    points = np.random.default_rng(seed).dirichlet(np.full(len(corners), 0.3), count) @ corners
    return projection.light.path_length(*points.T), projection.to_map(*points.T)[2]


def unevenness(before, after):
    """The share of the spread of depths, in [0, 1], that is no straight line of those before.

    0 if equal lengths along the light have equal depths all over the map.
    """
    line = np.polynomial.Polynomial.fit(before, after, 1)
    return np.std(after - line(before)) / np.std(after)


def aliasing(texels, pixels, p, n):
    """1 / |det J| at a point `p` of a surface with the normal `n`, of three components each.

    texels : of the shadow map, a `Projection` and its resolution.
    pixels : of the picture, a `Projection` by its camera's matrix, and its width and height.

    Components are floats, NumPy arrays or, of opaque projections, Dr.Jit arrays.
    """
    projection, resolution = texels
    camera, (width, height) = pixels
    pixel_density = width * height * magnification(camera, p, n)
    return pixel_density / (resolution**2 * magnification(projection, p, n))


def magnification(projection, p, n):
    """The area on the map's square, over that on the surface."""
    (u_x, v_x, _), (u_y, v_y, _), (u_z, v_z, _) = (
        projection.along(p, way) for way in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )
    return abs(
        n[0] * (u_y * v_z - u_z * v_y)
        + n[1] * (u_z * v_x - u_x * v_z)
        + n[2] * (u_x * v_y - u_y * v_x)
    )


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
