"""How much light arrives at patches of ground, and exact derivatives of it by what casts shadows.

A patch k weights the places of the ground by w_k; F_k is the share of its light that arrives. V(x)
is 1 where a shadow ray arrives, else 0. It jumps along the borders s of shadows:

    F_k = ∫ w_k V dx / ∫ w_k dx,    ∂F_k/∂θ = - ∮ (V_out - V_in) w_k v·n ds / ∫ w_k dx

v is the velocity of the border and n its normal, out of the shadow. Borders are shadows of a mesh's
silhouette edges, those between a triangle that faces the light and one that does not; rays on both
sides tell whether there is a border, or another shadow.
"""

import numpy as np

from brdfkit.shadows.comparison.tracked_points import is_lit

WIDTH = 0.3  # standard deviation of a patch
CENTRES = np.array([(x, y) for x in (-0.3, 0.4, 1.1) for y in (-0.5, 0.2, 0.9)])
PIECES = 64  # of an edge
ASIDE = 1e-3  # of a border, where rays go
STEP = 0.02  # of differences
SIDE = 1400  # points along a side of the ground for them


def weights(x, y):
    """w_k (patches, places), over their integrals."""
    squares = (x - CENTRES[:, :1]) ** 2 + (y - CENTRES[:, 1:]) ** 2
    return np.exp(-squares / (2 * WIDTH**2)) / (2 * np.pi * WIDTH**2)


def grid(side, low=-2.0, high=3.0):
    """Places x, y (side²,) in the middle of equal squares of ground, and the area of each."""
    ends = low + (np.arange(side) + 0.5) * (high - low) / side
    x, y = np.meshgrid(ends, ends)
    return x.ravel(), y.ravel(), ((high - low) / side) ** 2


def lit(scene, light, x, y):
    """V at places of the ground, by rays."""
    import mitsuba as mi

    p = mi.Point3f(mi.Float(x), mi.Float(y), mi.Float(np.zeros(len(x))))
    return is_lit(scene, light, p, mi.Normal3f(0, 0, 1))


def by_borders(scene, light, solid):
    """∂F/∂(x, y, z), (patches, 3), of a `solid` that moves, by the integral over borders."""
    starts, ends, inside = silhouette(solid, light)
    parts = (np.arange(PIECES) + 0.5) / PIECES
    edge = starts[:, None] + parts[:, None] * (ends - starts)[:, None]
    place = shadow(light, edge)
    along = velocity(light, edge, (ends - starts)[:, None] / PIECES)
    out = np.stack([along[..., 1], -along[..., 0]], axis=-1)  # n ds, or its opposite
    inwards = shadow(light, inside)[:, None] - place
    out *= -np.sign((out * inwards).sum(axis=-1, keepdims=True))
    n = out / np.linalg.norm(out, axis=-1, keepdims=True)
    beyond, within = (
        lit(scene, light, *(place + side * ASIDE * n).reshape(-1, 2).T).astype(float)
        for side in (1, -1)
    )
    w = weights(*place.reshape(-1, 2).T) * (beyond - within)
    speeds = [(velocity(light, edge, axis) * out).sum(axis=-1).ravel() for axis in np.eye(3)]
    return -w @ np.stack(speeds, axis=1)


def silhouette(solid, light):
    """Edges (n, 3) to (n, 3) between faces that are turned to the light and faces that are not, and
    another corner (n, 3) of a face at each."""
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


def shadow(light, points):
    """Where on the ground the shadows (..., 2) of points (..., 3) are."""
    x, y, z = np.moveaxis(points, -1, 0)
    a, b, c = light.direction(x, y, z)
    return np.stack([x - a / c * z, y - b / c * z], axis=-1)


def velocity(light, points, way, step=1e-4):
    """How fast the shadows (..., 2) of points (..., 3) that go a `way` (..., 3) move."""
    return (shadow(light, points + step * way) - shadow(light, points - step * way)) / (2 * step)


def by_differences(received):
    """Derivatives (patches, 3) of a function of a way (3,), by differences."""
    ways = np.eye(3) * STEP
    return np.stack([(received(way) - received(-way)) / (2 * STEP) for way in ways], axis=1)
