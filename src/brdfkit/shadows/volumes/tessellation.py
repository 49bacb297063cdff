"""Replaces Mitsuba's round shapes by triangles, with corners on the shapes, for shadow volumes.

The shadow of a ball becomes smaller by 0.03 % of its radius, 1 - cos(π/128). The triangles lie
within convex shapes, so that such shapes do not shadow themselves.
"""

from collections.abc import Sequence

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError

AROUND, UPWARDS = 128, 64  # numbers of triangles' edges around the axis, and from pole to pole


def tessellate_shape(shape: MitsubaObject) -> tuple[FloatArray, IntArray]:
    """Return the vertices (n, 3) and triangles (m, 3) of a Mitsuba sphere, cylinder or disk.

    The triangles are indices of their corners. Raises `BrdfkitError` for other shapes.
    """
    import mitsuba as mi

    kind = shape.class_name()
    if kind == "Sphere":
        theta = np.linspace(0, np.pi, UPWARDS + 1)
        points, triangles = revolve_profile(np.sin(theta), np.cos(theta), poles=(0, UPWARDS))
    elif kind == "Cylinder":
        points, triangles = revolve_profile(np.ones(2), np.arange(2.0))
    elif kind == "Disk":
        points, triangles = revolve_profile(np.arange(2.0), np.zeros(2), poles=(0,))
    else:
        raise BrdfkitError(
            f"{shape.id()}: shadow volumes need triangles, and this shape ({kind}) has none; "
            "replace it by a mesh."
        )
    to_world = np.array(mi.traverse(shape)["to_world"].matrix, float).reshape(4, 4)
    return points @ to_world[:3, :3].T + to_world[:3, 3], triangles


def revolve_profile(
    radius: FloatArray, height: FloatArray, poles: Sequence[int] = ()
) -> tuple[FloatArray, IntArray]:
    """Return the vertices and triangles of a surface of revolution about the z axis.

    Vertices are (n, 3); triangles are (m, 3), indices of their corners.

    radius, height : radius and height (k,) of the points of the surface's profile.
    poles : the indices of the profile's points that lie on the axis.
    """
    phi = np.arange(AROUND) * 2 * np.pi / AROUND
    circles = np.stack([np.outer(radius, np.cos(phi)), np.outer(radius, np.sin(phi))], axis=-1)
    points = np.dstack([circles, np.repeat(height, AROUND).reshape(-1, AROUND)]).reshape(-1, 3)
    row, column = np.divmod(np.arange((len(radius) - 1) * AROUND), AROUND)

    def vertex_index(row: IntArray, column: IntArray) -> IntArray:
        return row * AROUND + np.where(np.isin(row, poles), 0, column % AROUND)

    a, b = vertex_index(row, column), vertex_index(row, column + 1)
    c, d = vertex_index(row + 1, column), vertex_index(row + 1, column + 1)
    triangles = np.concatenate([np.column_stack([a, c, d]), np.column_stack([a, d, b])])
    flat = np.any(triangles == np.roll(triangles, 1, axis=1), axis=1)
    return points, triangles[~flat]
