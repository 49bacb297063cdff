"""Grids of distances to triangle meshes."""

from os import PathLike

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import contents
from brdfkit.distance_fields.export.mesh import INSTALL
from brdfkit.distance_fields.export.sampling import MARGIN, axes_of
from brdfkit.distance_fields.shapes.grids import grid


def from_mesh(
    mesh: str | PathLike[str] | tuple[ArrayLike, ArrayLike], resolution: int = 64
) -> grid:
    """The distance to a closed mesh as a grid, by libigl; its winding number says what is inside.

    Parameters
    ----------
    mesh : file, or (vertices, faces)
        OBJ, PLY, STL or OFF; or arrays (n, 3) and (m, 3).
    resolution : integer, default 64
        Cubic cells along the longest edge of the mesh's box and a margin.

    Returns
    -------
    grid
        Whose values are exact.

    Raises
    ------
    BrdfkitError
        Where the mesh is not closed or cannot be read, or libigl is not installed.

    Examples
    --------
    >>> cow = from_mesh("cow.obj", 128)
    """
    try:
        import igl
    except ImportError as error:
        raise BrdfkitError(f"libigl, which measures distances to meshes, {INSTALL}") from error

    vertices, faces = _welded(*_read(mesh, igl))
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    margin = MARGIN * (high - low).max()
    axes = axes_of(low - margin, high + margin, resolution)
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    kind = igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
    values = igl.signed_distance(points.reshape(-1, 3), vertices, faces, kind)[0]
    values = values.reshape(points.shape[:3]).transpose(2, 1, 0)
    return grid(values, tuple(low - margin), tuple(a[-1] for a in axes))


def _read(mesh, igl):
    """Vertices and faces, of a file or as they are given."""
    if isinstance(mesh, tuple):
        return np.asarray(mesh[0], float), np.asarray(mesh[1])
    contents(mesh)  # says what is wrong with a file that cannot be read at all
    try:
        return igl.read_triangle_mesh(str(mesh))
    except (RuntimeError, ValueError) as error:
        raise BrdfkitError(
            f"{mesh}: cannot be read as a mesh; give OBJ, PLY, STL or OFF."
        ) from error


def _welded(vertices, faces):
    """The mesh with equal vertices made one; an error unless it is closed."""
    vertices, first = np.unique(vertices, axis=0, return_inverse=True)
    faces = first.ravel()[faces.astype(np.int64)]
    faces = faces[(faces != faces[:, [1, 2, 0]]).all(axis=1)]  # without those of no area
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forth, times = np.unique(edges, axis=0, return_counts=True)
    back = np.unique(edges[:, ::-1], axis=0)
    alone = set(map(tuple, forth)) ^ set(map(tuple, back))
    alone |= set(map(tuple, forth[times > 1]))
    if not len(faces) or alone:
        edges = len(set(map(frozenset, alone)))
        raise BrdfkitError(
            f"the mesh is not closed: {edges} edges have one face only, or faces that are turned "
            "against each other; close its holes first."
        )
    return vertices, faces
