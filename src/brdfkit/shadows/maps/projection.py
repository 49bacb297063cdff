"""`Projection`: maps points of the world to coordinates and a depth on a shadow map, and back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitMask, JitVector
from brdfkit.core.projective.homogeneous import normalise, project, transform
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.placement import Placement

AnyProjection: TypeAlias = Any  # a `Projection`, or a `Cell`, which covers only a square of a map


@dataclass(frozen=True)
class LightDepth:
    """A depth that grows linearly with the distance from the light, whatever the projection.

    It makes the bounds of moment shadow maps tighter. But on a warped map this depth is not linear
    over a plane, so that wide filters, which extrapolate the receiver's tangent plane, let planes
    shadow themselves where texels are large. The default depth, by the projection's matrix, is
    linear over planes.

    start : distance from the light at which the depth is -1 [unit of length].
    length : distance over which the depth grows from -1 to 1 [unit of length].
    """

    start: Any
    length: Any

    @classmethod
    def from_placement(cls, placement: Placement) -> LightDepth:
        """Return a depth that covers the scene: from a point light, or where light rays enter."""
        light, reach = placement.light, placement.reach
        if not light.is_directional:
            return cls(0.0, reach)
        return cls(light.path_length(*(placement.low + placement.high) / 2) - reach / 2, reach)

    def make_opaque(self) -> LightDepth:
        """Return a copy with opaque Dr.Jit numbers, so that all maps share one compiled kernel."""
        import drjit as dr
        import mitsuba as mi

        return LightDepth(dr.opaque(mi.Float, self.start), dr.opaque(mi.Float, self.length))

    def to_depth(self, distance: JitFloat) -> JitFloat:
        """Return the depth, -1 to 1, of a point at this `distance` from the light."""
        return 2 * (distance - self.start) / self.length - 1

    def to_distance(self, depth: JitFloat) -> JitFloat:
        """Return the distance from the light of a point with this `depth`."""
        return self.start + (depth + 1) / 2 * self.length


@dataclass(frozen=True)
class Projection:
    """The projection of a shadow map, which maps a ray of light to one point of the map.

    Components are floats, NumPy arrays or, after `make_opaque`, Dr.Jit arrays.

    matrix : (4, 4), from the world to the cube [-1, 1]³: x and y on the map, and the depth, which
        grows away from the light.
    inverse : (4, 4), the inverse matrix.
    light : the `Light`; after `make_opaque`, its point is a `mi.Vector4f`.
    depth : the depth to use in place of the matrix's third coordinate, or None.
    """

    matrix: Any
    inverse: Any
    light: Light
    depth: LightDepth | None = None

    @classmethod
    def from_matrix(cls, matrix: FloatArray, light: Light) -> Projection:
        """Return the projection of a light by a `matrix` (4, 4), from the world to the map."""
        return cls(matrix, np.linalg.inv(matrix), light)

    def make_opaque(self) -> Projection:
        """Return a copy with opaque Dr.Jit numbers, so that all maps share one compiled kernel."""
        import drjit as dr
        import mitsuba as mi

        point: Any = mi.Vector4f(self.light.point)
        opaque = replace(
            self,
            matrix=mi.Matrix4f(self.matrix),
            inverse=mi.Matrix4f(self.inverse),
            light=replace(self.light, point=point),
            depth=self.depth and self.depth.make_opaque(),
        )
        dr.make_opaque(opaque.matrix, opaque.inverse, opaque.light.point)
        return opaque

    def project(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return the map coordinates and the depth of a world point, all in [-1, 1] on the map."""
        u, v, depth = project(self.matrix, x, y, z)
        return u, v, self.depth.to_depth(self.light.path_length(x, y, z)) if self.depth else depth

    def is_projectable(self, x: JitFloat, y: JitFloat, z: JitFloat) -> JitMask:
        """Return whether the projection can map a point at all: its homogeneous w is above 0."""
        return transform(self.matrix, x, y, z)[3] > 0

    def directional_derivative(self, point: JitVector, way: JitVector) -> tuple[JitFloat, ...]:
        """Return the derivatives of map coordinates and depth as a point moves along `way`."""
        *place, w = transform(self.matrix, *point)
        *change, change_w = transform(self.matrix, way[0], way[1], way[2], 0.0)
        u, v, depth = ((c - p / w * change_w) / w for p, c in zip(place, change, strict=True))
        if self.depth:
            light_way = zip(way, self.light.direction(*point), strict=True)
            depth = sum(a * b for a, b in light_way) * (2 / self.depth.length)
        return u, v, depth

    def direction_to_light(self, p: JitVector) -> JitVector:
        """Return the unit vectors from points `p` to the light; needs Dr.Jit numbers."""
        import mitsuba as mi

        return -mi.Vector3f(*self.light.direction(*p))

    def light_ray(self, x: JitFloat, y: JitFloat) -> tuple[Any, Any]:
        """Return origin and unit direction of the light ray through map coordinates x and y.

        The origin is the light, or for a directional light any point on the ray.
        """
        if self.light.is_directional:
            return project(self.inverse, x, y, 0.0), self.light.direction(0.0, 0.0, 0.0)
        # The ray's direction is its point at infinity: the combination, with w = 0, of two points
        *point, w = transform(self.inverse, x, y, 0.0)
        light = [self.light.point[i] for i in range(3)]
        return light, normalise(*(p - w * q for p, q in zip(point, light, strict=True)))

    def unproject(self, x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, ...]:
        """Return the world point that has the map coordinates x and y and the depth z."""
        if not self.depth:
            return project(self.inverse, x, y, z)
        origin, direction = self.light_ray(x, y)
        distance = self.depth.to_distance(z) - self.light.path_length(*origin)
        return tuple(o + d * distance for o, d in zip(origin, direction, strict=True))
