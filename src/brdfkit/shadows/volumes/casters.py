"""Which triangles of a mesh throw the shadow: those are the front caps of the volumes.

Each way gives every triangle a whole number: 1 where it casts as it is turned, -1 where it casts
turned over, so that it faces the light, and 0 where it casts nothing.

all : every triangle but those in whose plane the light is. Right for any mesh, open or closed,
    however its triangles are turned, and for a light within: a point is dark by as many triangles
    as lie between it and the light [Bergeron 1986]. An edge between a triangle that faced the light
    and one that did not bounds both, and its wall counts twice.
light_facing : those that face the light [Ergun 2008, 2.1.6]: half as many, for closed meshes.
facing_away : those that do not: the same shadow behind closed meshes; the insides of the shapes are
    lit. Its caps never touch a surface that is lit, so that nothing is darkened by its own cap.
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError


def every(mesh, light):
    return np.sign(towards(mesh, light)).astype(int)


def light_facing(mesh, light):
    require_solid(mesh, light)
    return faces_light(mesh, light).astype(int)


def facing_away(mesh, light):
    require_solid(mesh, light)
    return faces_light(mesh, light).astype(int) - 1


CASTERS = {"all": every, "light_facing": light_facing, "facing_away": facing_away}


def faces_light(mesh, light):
    """Whether each triangle (m,) faces a `Light`."""
    return towards(mesh, light) > 0


def towards(mesh, light):
    """N · L of each triangle (m,): 0 where the light is in its plane."""
    corner = mesh.points[mesh.triangles[:, 0]]
    to_light = light.point[:3] - light.point[3] * corner
    return np.einsum("ij,ij->i", mesh.normals, to_light)


def require_solid(mesh, light):
    """Raise `BrdfkitError` unless the mesh is closed, and the light outside of it."""
    _ = mesh.shared_edges
    if not light.is_directional and round(windings(mesh, light.point[:3])) != 0:
        raise BrdfkitError(
            f"{mesh.name}: the light is inside this shape; move it out, or use casters = all."
        )


def windings(mesh, place):
    """How often a mesh winds about a place (3,): the sum of its triangles' solid angles over 4π.

    [Van Oosterom & Strackee 1983]
    """
    a, b, c = (mesh.points[mesh.triangles] - place).transpose(1, 0, 2)
    x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", v, w) for v, w in ((a, b), (b, c), (c, a)))
    over = np.einsum("ij,ij->i", a, np.cross(b, c))
    return np.sum(2 * np.arctan2(over, x * y * z + ab * z + bc * x + ca * y)) / (4 * np.pi)
