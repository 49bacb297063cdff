"""Makes meshes of smooth surfaces p(u, v), with exact normals and with tangents along u.

An anisotropic material is brushed along the tangent. Mitsuba computes the tangent of a triangle
from the (u, v) of its vertices and rotates it into the plane of the interpolated normal, so the
tangents of a fine grid are nearly those of the surface.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, MitsubaObject
from brdfkit.core.jit.padding import pad

AROUND = 192  # number of grid columns around the axis of a surface of revolution


def make_grid_mesh(
    points: FloatArray, normals: FloatArray, bsdf: dict[str, Any] | MitsubaObject
) -> MitsubaObject:
    """Make a `mitsuba.Mesh` from a grid of points on a surface and their unit normals.

    `points` and `normals` are (rows, columns, 3). u runs along the columns and v along the rows,
    both from 0 to 1. On a closed surface the last row or column repeats the first. `bsdf` is the
    material, a dictionary or an object.
    """
    rows, columns = points.shape[:2]
    v, u = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")

    # Each cell of the grid, with the corners a, b in a row and c, d in the next, is two triangles
    number = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]
    faces = np.moveaxis(np.array([[a, b, d], [a, d, c]]), 1, -1).reshape(-1, 3)
    return make_mesh(points.reshape(-1, 3), normals.reshape(-1, 3), np.dstack([u, v]), faces, bsdf)


def make_mesh(
    points: FloatArray,
    normals: FloatArray,
    uv: FloatArray,
    faces: IntArray,
    bsdf: dict[str, Any] | MitsubaObject,
) -> MitsubaObject:
    """Make a `mitsuba.Mesh` from vertices (n, ...) and `faces` (m, 3), indices of their corners.

    Faces without an area are left out. The vertices of the others are ordered so that the face
    points in the direction of its normals.
    """
    import mitsuba as mi

    corners = points[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    turned = np.einsum("fi,fi->f", across, normals[faces].sum(axis=1)) < 0
    faces = np.where(turned[:, None], faces[:, ::-1], faces)[np.linalg.norm(across, axis=1) > 1e-12]

    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf, parallel=False) if isinstance(bsdf, dict) else bsdf
    made = mi.Mesh("mesh", len(points), len(faces), properties, True, True)
    buffers = mi.traverse(made)
    buffers["vertex_positions"] = pad(np.ravel(points).astype(np.float32))
    buffers["vertex_normals"] = pad(np.ravel(normals).astype(np.float32))
    buffers["vertex_texcoords"] = pad(np.ravel(uv).astype(np.float32))
    buffers["faces"] = pad(np.ravel(faces).astype(np.uint32))
    buffers.update()
    return made


def revolve_profile(
    r: FloatArray, z: FloatArray, between: int = 1
) -> tuple[FloatArray, FloatArray]:
    """Return a grid of points and their normals on a surface of revolution about the z axis.

    `r` and `z` are the radii and heights of points (n,) of the profile, which a cubic spline joins;
    the last point of a closed profile repeats the first. The inside of the surface is on the left
    of the profile. `between` is the number of rows from one point to the next. u runs around the
    axis, v along the profile.
    """
    from scipy.interpolate import CubicSpline

    way = np.concatenate([[0], np.cumsum(np.hypot(np.diff(r), np.diff(z)))])
    closed = r[0] == r[-1] and z[0] == z[-1]
    spline = CubicSpline(way, np.column_stack([r, z]), bc_type="periodic" if closed else "natural")
    rows = between * (len(way) - 1) + 1
    place = np.interp(np.linspace(0, len(way) - 1, rows), np.arange(len(way)), way)
    (r, z), (dr, dz) = spline(place).T, spline(place, 1).T
    phi = np.linspace(0, 2 * np.pi, AROUND + 1)
    length = np.hypot(dr, dz)
    return rotate_profile(r, z, phi), rotate_profile(dz / length, -dr / length, phi)


def rotate_profile(r: FloatArray, z: FloatArray, phi: FloatArray) -> FloatArray:
    """Return points (rows, columns, 3) on a surface of revolution about the z axis.

    `r` and `z` (rows,) are the radii and heights of its profile, and `phi` (columns,) the angles.
    """
    x, y = np.multiply.outer(r, np.cos(phi)), np.multiply.outer(r, np.sin(phi))
    return np.stack([x, y, np.broadcast_to(np.asarray(z)[:, None], x.shape)], axis=-1)
