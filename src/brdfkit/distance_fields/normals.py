"""Normals: the direction in which f grows.

By four values of f at the corners of a tetrahedron. Automatic differentiation would be exact, but
Dr.Jit has no derivatives of derivatives: these normals have them, by every parameter of f.
"""

import drjit as dr

CORNERS = ((1, -1, -1), (-1, -1, 1), (-1, 1, -1), (1, 1, 1))


def normal(distance, p, step=1e-3):
    """The unit normal of `distance` at `p`, of its type; `step` should be below all details."""
    x, y, z = 0.0, 0.0, 0.0
    for i, j, k in CORNERS:
        f = distance(p + type(p)(i * step, j * step, k * step))
        x, y, z = x + i * f, y + j * f, z + k * f
    size = dr.sqrt(dr.maximum(x * x + y * y + z * z, 1e-30))
    return type(p)(x / size, y / size, z / size)
