"""Triangles of Mitsuba's round shapes, whose corners lie on them.

A ball's shadow is smaller by 1 - cos(π/128), 0.03 % of its radius; a shape that bulges is not
shadowed by its own triangles, which lie within.
"""

import numpy as np

from brdfkit.errors import BrdfkitError

AROUND, UPWARDS = 128, 64  # steps about the axis, and from pole to pole


def tessellated(shape):
    """The points (n, 3) and triangles (m, 3) of a sphere, cylinder or disk of Mitsuba's.

    Raises `BrdfkitError` for other shapes.
    """
    import mitsuba as mi

    kind = shape.shape_type()
    if kind == int(mi.ShapeType.Sphere):
        along, poles, axis = UPWARDS, (0, UPWARDS), 0
    elif kind == int(mi.ShapeType.Cylinder):
        along, poles, axis = 1, (), 0
    elif kind == int(mi.ShapeType.Disk):
        along, poles, axis = 1, (0,), 1  # u is the radius, v the angle
    else:
        raise BrdfkitError(
            f"{shape.id()}: shadow volumes are made of triangles, and this shape "
            f"({shape.class_name()}) has none; replace it by a mesh."
        )
    row, column = np.divmod(np.arange((along + 1) * AROUND), AROUND)
    uv = [column / AROUND, row / along]
    u, v = (mi.Float(value) for value in (uv if axis == 0 else uv[::-1]))
    points = np.array(shape.eval_parameterization(mi.Point2f(u, v)).p, float).T
    return points, grid(along, poles)


def grid(along, poles):
    """The triangles of a strip that closes around; a row that is one of the `poles` is a point."""
    row, column = np.divmod(np.arange(along * AROUND), AROUND)

    def number(row, column):
        return row * AROUND + np.where(np.isin(row, poles), 0, column % AROUND)

    a, b = number(row, column), number(row, column + 1)
    c, d = number(row + 1, column), number(row + 1, column + 1)
    triangles = np.concatenate([np.column_stack([a, c, d]), np.column_stack([a, d, b])])
    ends = triangles, np.roll(triangles, 1, axis=1)
    return triangles[np.all(ends[0] != ends[1], axis=1)]
