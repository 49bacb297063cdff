"""Triangle meshes of distance fields."""

from os import PathLike
from typing import Any, NamedTuple

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import write_safely
from brdfkit.distance_fields.export.sampling import to_grid

HEADER = """ply
format binary_little_endian 1.0
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""
NOT_INSTALLED = 'is not installed; pip install "brdfkit[distance_fields]".'


class Mesh(NamedTuple):
    """A triangle mesh.

    `vertices`: points (n, 3).
    `faces`: indices (m, 3) of the triangles' vertices, anticlockwise seen from outside.
    """

    vertices: FloatArray
    faces: IntArray

    def write(self, path: str | PathLike[str]) -> None:
        """Write a binary PLY file, which Mitsuba and modellers read."""
        rows = np.empty(len(self.faces), [("count", "u1"), ("corners", "<i4", 3)])
        rows["count"], rows["corners"] = 3, self.faces
        header = HEADER.format(vertices=len(self.vertices), faces=len(rows))
        data = np.asarray(self.vertices, "<f4").tobytes() + rows.tobytes()
        with write_safely(path) as beside:
            beside.write_bytes(header.encode() + data)


def to_mesh(node: Any, resolution: int = 64, bounds: Any = None) -> Mesh:
    """Return the surface of a field as triangles, by marching cubes on a grid of samples.

    Parameters
    ----------
    node : distance field
        The field.
    resolution : integer, default 64
        The number of cells along the longest edge of the box.
    bounds : (low, high), optional
        The corners of the box; by default the surface's own box with a margin.

    Returns
    -------
    Mesh
        Triangles whose vertices are at most half a cell times `node.lipschitz` from the surface.

    Raises
    ------
    BrdfkitError
        If there is no surface in the box, or scikit-image is not installed.

    Examples
    --------
    >>> vertices, faces = to_mesh(sphere(1) - box(1))
    >>> to_mesh(sphere(1) - box(1)).write("cut.ply")    # doctest: +SKIP
    """
    try:
        from skimage.measure import marching_cubes
    except ImportError as error:
        raise BrdfkitError(f"scikit-image, which makes meshes, {NOT_INSTALLED}") from error

    sampled = to_grid(node, resolution, bounds)
    values = sampled.values.transpose(2, 1, 0)
    vertices, faces, _, _ = marching_cubes(values, 0.0, spacing=tuple(sampled.spacing))
    return Mesh(vertices + np.array(sampled.low), faces)
