"""Meshes of smooth surfaces p(u, v), with exact normals, and tangents along u for brushing.

Mitsuba takes a triangle's tangent from its vertices' (u, v), and turns it into the plane of the
normal between them: a fine grid gives the tangents of the surface itself.
"""

import numpy as np

from brdfkit.core.jit.padding import pad

AROUND = 192  # columns of a surface of revolution


def mesh_of_grid(points, normals, bsdf):
    """A `mitsuba.Mesh` of `points` (rows, columns, 3) of a surface, with unit `normals` there.

    u runs along the columns, v along the rows, both from 0 to 1. A surface that closes has its
    first points again as its last. `bsdf`: the material, as a dictionary or an object.
    """
    rows, columns = points.shape[:2]
    v, u = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")

    # two triangles a cell, from its corners a b (this row) and c d (the next)
    number = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]
    faces = np.moveaxis(np.array([[a, b, d], [a, d, c]]), 1, -1).reshape(-1, 3)
    return mesh(points.reshape(-1, 3), normals.reshape(-1, 3), np.dstack([u, v]), faces, bsdf)


def mesh(points, normals, uv, faces, bsdf):
    """A `mitsuba.Mesh` of vertices and of `faces` (n, 3), their numbers; none without an area.

    Faces are turned so that they face where their normals do.
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


def revolve(r, z, between=1):
    """(points, normals) of the surface that a profile sweeps about the z axis; a grid for a mesh.

    `r`, `z`: points of the profile, which a cubic spline joins; where it closes, its first point is
    its last. The inside lies to the left of the profile's way. `between`: rows from a point to the
    next: set the points close where it bends much. u runs around the axis, v along the profile.
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
    return around_z(r, z, phi), around_z(dz / length, -dr / length, phi)


def around_z(r, z, phi):
    """Points (rows, columns, 3) at the radii `r` and heights `z` (rows), and angles `phi`."""
    x, y = np.multiply.outer(r, np.cos(phi)), np.multiply.outer(r, np.sin(phi))
    return np.stack([x, y, np.broadcast_to(np.asarray(z)[:, None], x.shape)], axis=-1)
