"""Grids of signed distances to triangle meshes."""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import read_bytes
from brdfkit.distance_fields.export.mesh import NOT_INSTALLED
from brdfkit.distance_fields.export.sampling import make_grid_axes
from brdfkit.distance_fields.shapes.grids import grid

MARGIN = 0.05  # width of the margin around a mesh, as a share of its box's longest edge


def from_mesh(
    mesh: str | PathLike[str] | tuple[ArrayLike, ArrayLike], resolution: int = 64
) -> grid:
    """Return the signed distance to a closed mesh, sampled on a grid by libigl.

    Parameters
    ----------
    mesh : file, or (vertices, faces)
        An OBJ, PLY, STL or OFF file; or arrays (n, 3) and (m, 3).
    resolution : integer, default 64
        The number of cubic cells along the longest edge of the mesh's box and a margin.

    Returns
    -------
    grid
        A grid with exact distances; the mesh's winding number gives their sign.

    Raises
    ------
    BrdfkitError
        If the mesh is not closed or cannot be read, or libigl is not installed.

    Examples
    --------
    >>> cow = from_mesh("cow.obj", 128)
    """
    try:
        import igl
    except ImportError as error:
        raise BrdfkitError(
            f"libigl, which measures distances to meshes, {NOT_INSTALLED}"
        ) from error

    vertices, faces = _weld_closed_mesh(*_read_mesh(mesh, igl))
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    margin = MARGIN * (high - low).max()
    axes = make_grid_axes(low - margin, high + margin, resolution)
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    method = igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
    values = igl.signed_distance(points.reshape(-1, 3), vertices, faces, method)[0]
    values = values.reshape(points.shape[:3]).transpose(2, 1, 0)
    return grid(values, tuple(low - margin), tuple(a[-1] for a in axes))


def _read_mesh(mesh: Any, igl: Any) -> tuple[AnyArray, AnyArray]:
    """Return the vertices (n, 3) and faces (m, 3) of a file, or of a pair of arrays."""
    if isinstance(mesh, tuple):
        return np.asarray(mesh[0], float), np.asarray(mesh[1])
    read_bytes(mesh)  # raises a clear error for a file that cannot be opened
    try:
        vertices, faces = igl.read_triangle_mesh(str(mesh))
    except (RuntimeError, ValueError) as error:
        raise BrdfkitError(
            f"{mesh}: cannot be read as a mesh; give OBJ, PLY, STL or OFF."
        ) from error
    return vertices, faces


def _weld_closed_mesh(vertices: AnyArray, faces: AnyArray) -> tuple[AnyArray, AnyArray]:
    """Return the mesh with equal vertices merged; raise `BrdfkitError` unless it is closed."""
    vertices, first = np.unique(vertices, axis=0, return_inverse=True)
    faces = first.ravel()[faces.astype(np.int64)]
    # Leave out triangles in which merging made two corners one
    faces = faces[(faces != faces[:, [1, 2, 0]]).all(axis=1)]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forth, times = np.unique(edges, axis=0, return_counts=True)
    back = np.unique(edges[:, ::-1], axis=0)
    unpaired = set(map(tuple, forth)) ^ set(map(tuple, back))
    unpaired |= set(map(tuple, forth[times > 1]))
    if not len(faces) or unpaired:
        count = len(set(map(frozenset, unpaired)))
        raise BrdfkitError(
            f"the mesh is not closed: {count} edges have only one face, or faces of opposite "
            "orientation; close its holes first."
        )
    return vertices, faces
