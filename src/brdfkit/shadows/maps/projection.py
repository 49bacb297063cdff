"""The projection of a shadow map: from the world to the map's square and to depth, and back."""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.projective.homogeneous import normalise, project, transform
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.light_depth import LightDepth


@dataclass(frozen=True)
class Projection:
    """A projection by a matrix, through the light: points on one ray of light share x and y.

    Components are floats, NumPy arrays or, of an `opaque` one, Dr.Jit arrays.

    matrix : (4, 4), from the world to the cube [-1, 1]³ of the map. Depth, the third coordinate,
        grows away from the light.
    inverse : (4, 4), the way back.
    light : the `Light`; of an opaque one, its point is a `mi.Vector4f`.
    depth : a `LightDepth`, which replaces the third coordinate of the matrix; None keeps that.
    """

    matrix: np.ndarray
    inverse: np.ndarray
    light: Light
    depth: LightDepth | None = None

    @classmethod
    def by(cls, matrix, light):
        """The projection by a `matrix` (4, 4)."""
        return cls(matrix, np.linalg.inv(matrix), light)

    def opaque(self):
        """The same for Dr.Jit; one kernel serves every matrix."""
        import drjit as dr
        import mitsuba as mi

        found = replace(
            self,
            matrix=mi.Matrix4f(self.matrix),
            inverse=mi.Matrix4f(self.inverse),
            light=replace(self.light, point=mi.Vector4f(self.light.point)),
            depth=self.depth and self.depth.opaque(),
        )
        dr.make_opaque(found.matrix, found.inverse, found.light.point)
        return found

    def to_map(self, x, y, z):
        """Where a point of the world is in the cube."""
        u, v, depth = project(self.matrix, x, y, z)
        return u, v, self.depth.of(self.light.path_length(x, y, z)) if self.depth else depth

    def is_before(self, x, y, z):
        """Whether the projection maps a point at all: w > 0."""
        return transform(self.matrix, x, y, z)[3] > 0

    def along(self, point, way):
        """The derivative of `to_map` at a `point` along a `way`, both of three components."""
        *place, w = transform(self.matrix, *point)
        *change, change_w = transform(self.matrix, *way, 0.0)
        u, v, depth = ((c - p / w * change_w) / w for p, c in zip(place, change, strict=True))
        if self.depth:
            light_way = zip(way, self.light.direction(*point), strict=True)
            depth = sum(a * b for a, b in light_way) * (2 / self.depth.length)
        return u, v, depth

    def to_light(self, p):
        """The unit vectors from points `p` to the light; of an opaque projection."""
        import mitsuba as mi

        return -mi.Vector3f(*self.light.direction(*p))

    def ray(self, x, y):
        """The ray of light at a place of the map: its origin, the light or, of one far away, a
        point on the ray; and its unit direction."""
        if self.light.is_directional:
            return project(self.inverse, x, y, 0.0), self.light.direction(0.0, 0.0, 0.0)
        # of the homogeneous points on it, that at infinity
        *point, w = transform(self.inverse, x, y, 0.0)
        light = [self.light.point[i] for i in range(3)]
        way = [p - w * q for p, q in zip(point, light, strict=True)]
        return light, normalise(*way)

    def from_map(self, x, y, z):
        """The point of the world at a place in the cube."""
        if not self.depth:
            return project(self.inverse, x, y, z)
        origin, direction = self.ray(x, y)
        way = self.depth.way(z) - self.light.path_length(*origin)
        return tuple(o + d * way for o, d in zip(origin, direction, strict=True))
