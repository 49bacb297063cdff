"""The projection of a shadow map: from the world to the map's square and to depth, and back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitMask, JitVector
from brdfkit.core.projective.homogeneous import normalise, project, transform
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.placement import Placement

AnyProjection: TypeAlias = Any  # a `Projection`, or a `Cell` of one


@dataclass(frozen=True)
class LightDepth:
    """Depth that grows evenly along every ray of light, whatever the projection.

    It is -1 at the distance `start` from the light and 1 a `length` later [unit of length]. It
    makes the bounds by moments tighter. But a plane is bent on a warped map of it, so that wide
    filters, which follow the receiver's plane, see the plane shadow itself where texels are large.
    Depths by the projection's own matrix keep planes planes, and are the default.
    """

    start: Any
    length: Any

    @classmethod
    def from_placement(cls, placement: Placement) -> LightDepth:
        """Return the depth that begins where the light enters the scene, or at a point light."""
        light, reach = placement.light, placement.reach
        if not light.is_directional:
            return cls(0.0, reach)
        return cls(light.path_length(*(placement.low + placement.high) / 2) - reach / 2, reach)

    def opaque(self) -> LightDepth:
        """Return the depth with opaque Dr.Jit numbers, so that one kernel serves all."""
        import drjit as dr
        import mitsuba as mi

        return LightDepth(dr.opaque(mi.Float, self.start), dr.opaque(mi.Float, self.length))

    def to_depth(self, distance: JitFloat) -> JitFloat:
        """Return the depth of a place at this `distance` from the light."""
        return 2 * (distance - self.start) / self.length - 1

    def to_distance(self, depth: JitFloat) -> JitFloat:
        """Return the distance from the light of a place with this `depth`."""
        return self.start + (depth + 1) / 2 * self.length


@dataclass(frozen=True)
class Projection:
    """A projection by a matrix, through the light: points on one ray of light share x and y.

    Components are floats, NumPy arrays or, of an `opaque` projection, Dr.Jit arrays.

    matrix : (4, 4), from the world to the cube [-1, 1]³ of the map. Depth, the third coordinate,
        grows away from the light.
    inverse : (4, 4), the inverse matrix.
    light : the `Light`; of an opaque one, its point is a `mi.Vector4f`.
    depth : replaces the third coordinate of the matrix; None keeps that.
    """

    matrix: Any
    inverse: Any
    light: Light
    depth: LightDepth | None = None

    @classmethod
    def from_matrix(cls, matrix: FloatArray, light: Light) -> Projection:
        """Return the projection by a `matrix` (4, 4)."""
        return cls(matrix, np.linalg.inv(matrix), light)

    def opaque(self) -> Projection:
        """Return the projection with opaque Dr.Jit numbers, so that one kernel serves all."""
        import drjit as dr
        import mitsuba as mi

        point: Any = mi.Vector4f(self.light.point)
        opaque = replace(
            self,
            matrix=mi.Matrix4f(self.matrix),
            inverse=mi.Matrix4f(self.inverse),
            light=replace(self.light, point=point),
            depth=self.depth and self.depth.opaque(),
        )
        dr.make_opaque(opaque.matrix, opaque.inverse, opaque.light.point)
        return opaque

    def to_map(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return where a point of the world is in the map's cube."""
        u, v, depth = project(self.matrix, x, y, z)
        return u, v, self.depth.to_depth(self.light.path_length(x, y, z)) if self.depth else depth

    def is_before(self, x: JitFloat, y: JitFloat, z: JitFloat) -> JitMask:
        """Return whether the projection maps a point at all: w > 0."""
        return transform(self.matrix, x, y, z)[3] > 0

    def derivative_along(self, point: JitVector, way: JitVector) -> tuple[JitFloat, ...]:
        """Return the derivative of `to_map` at a `point` along a vector `way`."""
        *place, w = transform(self.matrix, *point)
        *change, change_w = transform(self.matrix, way[0], way[1], way[2], 0.0)
        u, v, depth = ((c - p / w * change_w) / w for p, c in zip(place, change, strict=True))
        if self.depth:
            light_way = zip(way, self.light.direction(*point), strict=True)
            depth = sum(a * b for a, b in light_way) * (2 / self.depth.length)
        return u, v, depth

    def to_light(self, p: JitVector) -> JitVector:
        """Return the unit vectors from points `p` to the light; of an opaque projection."""
        import mitsuba as mi

        return -mi.Vector3f(*self.light.direction(*p))

    def ray(self, x: JitFloat, y: JitFloat) -> tuple[Any, Any]:
        """Return the ray of light at a place of the map: its origin and its unit direction.

        The origin is the light, or a point on the ray of a directional light.
        """
        if self.light.is_directional:
            return project(self.inverse, x, y, 0.0), self.light.direction(0.0, 0.0, 0.0)
        # The ray's direction is its homogeneous point at infinity
        *point, w = transform(self.inverse, x, y, 0.0)
        light = [self.light.point[i] for i in range(3)]
        return light, normalise(*(p - w * q for p, q in zip(point, light, strict=True)))

    def from_map(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return the point of the world at a place in the map's cube."""
        if not self.depth:
            return project(self.inverse, x, y, z)
        origin, direction = self.ray(x, y)
        distance = self.depth.to_distance(z) - self.light.path_length(*origin)
        return tuple(o + d * distance for o, d in zip(origin, direction, strict=True))
