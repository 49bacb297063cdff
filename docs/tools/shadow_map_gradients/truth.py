"""Computes exact derivatives of the light that patches of ground receive, by the object above.

Patch k weights the points x of the ground by w_k, and F_k is the share of its light that arrives.
The visibility V(x) is 1 where a shadow ray reaches the light, else 0. It jumps along the borders s
of shadows. So the derivative by a parameter θ of the object is an integral along the borders:

    F_k = ∫ w_k V dx / ∫ w_k dx,    ∂F_k/∂θ = - ∮ (V_out - V_in) w_k v·n ds / ∫ w_k dx

v is the velocity of the border and n its normal, out of the shadow. Borders are shadows of the
silhouette edges of a mesh, edges between a triangle that faces the light and one that does not.
Rays on both sides tell whether a border is real, or within another shadow.
"""

import numpy as np

from brdfkit.shadows.comparison.tracked_points import is_lit

WIDTH = 0.3  # standard deviation of a patch, a Gaussian function
CENTRES = np.array([(x, y) for x in (-0.3, 0.4, 1.1) for y in (-0.5, 0.2, 0.9)])
PIECES = 64  # number of pieces into which an edge is divided for the integral
ASIDE = 1e-3  # distance from a border at which rays test both sides
STEP = 0.02  # step of the object in finite differences
SIDE = 1400  # number of points along a side of the ground for finite differences


def weigh_places(x, y):
    """Return the weights w_k (patches, points) over their integrals, at points x, y (points,)."""
    squares = (x - CENTRES[:, :1]) ** 2 + (y - CENTRES[:, 1:]) ** 2
    return np.exp(-squares / (2 * WIDTH**2)) / (2 * np.pi * WIDTH**2)


def make_grid(side, low=-2.0, high=3.0):
    """Return x, y (side²,) of the centres of equal squares of ground, and the area of each."""
    ends = low + (np.arange(side) + 0.5) * (high - low) / side
    x, y = np.meshgrid(ends, ends)
    return x.ravel(), y.ravel(), ((high - low) / side) ** 2


def trace_visibility(scene, light, x, y):
    """Return the visibility V (n,) at points of the ground, by shadow rays."""
    import mitsuba as mi

    p = mi.Point3f(mi.Float(x), mi.Float(y), mi.Float(np.zeros(len(x))))
    return is_lit(scene, light, p, mi.Normal3f(0, 0, 1))


def integrate_borders(scene, light, solid):
    """Return ∂F/∂(x, y, z) (patches, 3) by a `solid`'s position, by the integral along borders."""
    starts, ends, inside = find_silhouette(solid, light)
    parts = (np.arange(PIECES) + 0.5) / PIECES
    edge = starts[:, None] + parts[:, None] * (ends - starts)[:, None]
    place = project_shadow(light, edge)
    along = compute_shadow_velocity(light, edge, (ends - starts)[:, None] / PIECES)
    out = np.stack([along[..., 1], -along[..., 0]], axis=-1)  # n ds, up to the sign
    inwards = project_shadow(light, inside)[:, None] - place
    out *= -np.sign((out * inwards).sum(axis=-1, keepdims=True))
    n = out / np.linalg.norm(out, axis=-1, keepdims=True)
    beyond, within = (
        trace_visibility(scene, light, *(place + side * ASIDE * n).reshape(-1, 2).T).astype(float)
        for side in (1, -1)
    )
    w = weigh_places(*place.reshape(-1, 2).T) * (beyond - within)
    speeds = [
        (compute_shadow_velocity(light, edge, axis) * out).sum(axis=-1).ravel()
        for axis in np.eye(3)
    ]
    return -w @ np.stack(speeds, axis=1)


def find_silhouette(solid, light):
    """Return the silhouette edges of a solid, and a corner of a face at each.

    The result is (starts, ends, corners), each (n, 3), of edges between a face that is turned to
    the light and one that is not.
    """
    corners = solid.corners[solid.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    turned = (normals * light.directions_to_light(corners[:, 0])).sum(axis=1) > 0
    is_turned = {}
    for (a, b, c), its in zip(solid.triangles.tolist(), turned, strict=True):
        is_turned |= {(a, b): (its, c), (b, c): (its, a), (c, a): (its, b)}
    found = [
        (a, b, c) for (a, b), (its, c) in is_turned.items() if a < b and is_turned[b, a][0] != its
    ]
    return np.moveaxis(solid.corners[np.array(found)], 1, 0)


def project_shadow(light, points):
    """Return the positions (..., 2) on the ground of the shadows of points (..., 3)."""
    x, y, z = np.moveaxis(points, -1, 0)
    a, b, c = light.direction(x, y, z)
    return np.stack([x - a / c * z, y - b / c * z], axis=-1)


def compute_shadow_velocity(light, points, way, step=1e-4):
    """Return the velocities (..., 2) of the shadows of points (..., 3) that move along `way`."""
    return (
        project_shadow(light, points + step * way) - project_shadow(light, points - step * way)
    ) / (2 * step)


def differentiate_numerically(received):
    """Return derivatives (patches, 3) of a function of a displacement (3,), by differences."""
    ways = np.eye(3) * STEP
    return np.stack([(received(way) - received(-way)) / (2 * STEP) for way in ways], axis=1)
