"""Triangles of Mitsuba's round shapes, whose corners lie on them.

A ball's shadow is smaller by 1 - cos(π/128), 0.03 % of its radius; a shape that bulges is not
shadowed by its own triangles, which lie within.
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError

AROUND, UPWARDS = 128, 64  # steps about the axis, and from pole to pole


def tessellated(shape):
    """The points (n, 3) and triangles (m, 3) of a sphere, cylinder or disk of Mitsuba's.

    Raises `BrdfkitError` for other shapes.
    """
    import mitsuba as mi

    kind = shape.class_name()
    if kind == "Sphere":
        theta = np.linspace(0, np.pi, UPWARDS + 1)
        points, triangles = turned(np.sin(theta), np.cos(theta), poles=(0, UPWARDS))
    elif kind == "Cylinder":
        points, triangles = turned(np.ones(2), np.arange(2.0))
    elif kind == "Disk":
        points, triangles = turned(np.arange(2.0), np.zeros(2), poles=(0,))
    else:
        raise BrdfkitError(
            f"{shape.id()}: shadow volumes are made of triangles, and this shape "
            f"({kind}) has none; replace it by a mesh."
        )
    to_world = np.array(mi.traverse(shape)["to_world"].matrix, float).reshape(4, 4)
    return points @ to_world[:3, :3].T + to_world[:3, 3], triangles


def turned(radius, height, poles=()):
    """Points (n, 3) and triangles (m, 3) of a line, `radius` (k,) by `height` (k,), turned about z.

    poles : the numbers of the line's points that lie on the axis.
    """
    phi = np.arange(AROUND) * 2 * np.pi / AROUND
    points = np.stack([np.outer(radius, np.cos(phi)), np.outer(radius, np.sin(phi))], axis=-1)
    points = np.dstack([points, np.repeat(height, AROUND).reshape(-1, AROUND)]).reshape(-1, 3)
    row, column = np.divmod(np.arange((len(radius) - 1) * AROUND), AROUND)

    def number(row, column):
        return row * AROUND + np.where(np.isin(row, poles), 0, column % AROUND)

    a, b = number(row, column), number(row, column + 1)
    c, d = number(row + 1, column), number(row + 1, column + 1)
    triangles = np.concatenate([np.column_stack([a, c, d]), np.column_stack([a, d, b])])
    flat = np.any(triangles == np.roll(triangles, 1, axis=1), axis=1)
    return points, triangles[~flat]
