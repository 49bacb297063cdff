"""The projection of a shadow map: from the world to the map's square and to depth, and back."""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.projective.homogeneous import project, transform
from brdfkit.projective.light import Light


@dataclass(frozen=True)
class Projection:
    """A projection by a matrix, through the light: points on one ray of light share x and y.

    Components are floats, NumPy arrays or, of an `opaque` one, Dr.Jit arrays.

    matrix : (4, 4), from the world to the cube [-1, 1]³ of the map. Depth, the third coordinate,
        grows away from the light.
    inverse : (4, 4), the way back.
    light : the `Light`; of an opaque one, its point is a `mi.Vector4f`.
    """

    matrix: np.ndarray
    inverse: np.ndarray
    light: Light

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
        )
        dr.make_opaque(found.matrix, found.inverse, found.light.point)
        return found

    def to_map(self, x, y, z):
        """Where a point of the world is in the cube."""
        return project(self.matrix, x, y, z)

    def is_before(self, x, y, z):
        """Whether the projection maps a point at all: w > 0."""
        return transform(self.matrix, x, y, z)[3] > 0

    def along(self, point, way):
        """The derivative of `to_map` at a `point` along a `way`, both of three components."""
        *place, w = transform(self.matrix, *point)
        *change, change_w = transform(self.matrix, *way, 0.0)
        return tuple((c - p / w * change_w) / w for p, c in zip(place, change, strict=True))

    def to_light(self, p):
        """The unit vectors from points `p` to the light; of an opaque projection."""
        import drjit as dr
        import mitsuba as mi

        place = mi.Vector3f(self.light.point.xyz)
        if self.light.is_directional:
            return place
        return dr.normalize(place - mi.Vector3f(p))

    def from_map(self, x, y, z):
        """The point of the world at a place in the cube."""
        return project(self.inverse, x, y, z)
