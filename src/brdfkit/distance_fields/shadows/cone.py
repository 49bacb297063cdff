"""The cone between a surface point and a light, in which a march searches for occluders.

The cone touches a ball of radius r_0 around the surface point and the ball of the light, of radius
r_1:

    sin α = (r_1 - r_0) / d,    R_i = r_i / cos α,    ρ(t) = R_0 + t tan α

d is the distance of the balls' centres, R_0 and R_1 are the radii of the cone's sections there, and
ρ(t) is the radius at the distance t. The ball around the surface point contains no object and is
about as large as a pixel. As the march starts with this radius, it needs no small first steps, and
no edge of its shadows is sharper than a pixel.

[Bálint et al. 2019, section 4.1]
"""

from dataclasses import dataclass, field, replace
from math import pi
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector

# The limit of the sine of a cone's half angle, as balls that lie within each other have no cone
LARGEST_SINE = 0.999
POINT_RADIUS = 1e-6  # the least radius of a section, as a share of the cone's length
# The radius, as a share of the widest one, at which the cone counts as ended in a tip
TIP_RADIUS = 1e-3


@dataclass(frozen=True)
class LightCone:
    """A truncated cone from a surface point to a light, in which occluders are searched.

    start, axis : the surface point, and the unit vector from there; Dr.Jit types of any backend.
    d : Float, the length of the axis.
    R_0, R_1 : Float, the radii of the sections at its start and its end.
    tan : Float, the growth of the radius per length along the axis.
    basis : two unit vectors at right angles to the axis and to each other.
    """

    start: Any
    axis: Any
    d: Any
    R_0: Any
    R_1: Any
    tan: Any = field(init=False)
    basis: tuple[Any, Any] = field(init=False)

    def __post_init__(self) -> None:
        # Not computed on demand: a value first computed within a Dr.Jit loop is invalid after it
        z = dr.abs(self.axis.z) > 0.5
        side = type(self.axis)(dr.select(z, 1, 0), 0, dr.select(z, 0, 1))
        a = dr.normalize(side - self.axis * dr.dot(side, self.axis))
        object.__setattr__(self, "tan", (self.R_1 - self.R_0) / self.d)
        object.__setattr__(self, "basis", (a, dr.cross(self.axis, a)))

    def radius(self, t: JitFloat) -> JitFloat:
        """Return the radius of the cone's section at t; never 0, so that ratios are finite."""
        return dr.maximum(self.R_0 + t * self.tan, POINT_RADIUS * self.d)

    def point(self, t: JitFloat) -> JitVector:
        """Return the point of the axis at the distance t from the start."""
        return self.start + self.axis * t

    def disc_point(self, t: JitFloat, x: JitFloat, y: JitFloat) -> JitVector:
        """Return the point of the section at t with the coordinates (x, y) on the unit disc."""
        a, b = self.basis
        return self.point(t) + (a * x + b * y) * self.radius(t)

    def project_to_disc(self, point: JitVector) -> tuple[JitFloat, JitFloat]:
        """Return the coordinates (x, y) on the unit disc of a `point` seen from the cone's apex."""
        a, b = self.basis
        offset = point - self.start
        radius = self.radius(dr.dot(offset, self.axis))
        return dr.dot(offset, a) / radius, dr.dot(offset, b) / radius

    def make_reversed(self) -> "LightCone":
        """Return the cone from the light to the surface point."""
        return LightCone(self.point(self.d), -self.axis, self.d, self.R_1, self.R_0)

    def narrow_to_centre(self) -> "LightCone":
        """Return the cone to the centre of the light alone, as to a light of radius 0."""
        return replace(self, R_1=0 * self.R_1)

    def make_detached(self) -> "LightCone":
        """Return the same cone without derivatives."""
        fields = self.start, self.axis, self.d, self.R_0, self.R_1
        return LightCone(*(dr.detach(field) for field in fields))

    def bound_step_count(self, epsilon: float, lipschitz: float = 1.0) -> JitFloat:
        """Return an upper bound on the steps of a march along the cone, in any field.

        A step is at least e ρ / (L + |tan α|) long, with the cone's radius ρ and half angle α, the
        field's bound L = `lipschitz`, and e = `epsilon` π / 2.
        """
        wide = dr.maximum(self.R_0, self.R_1)
        narrow = dr.maximum(dr.minimum(self.R_0, self.R_1), TIP_RADIUS * wide)
        tan = dr.maximum(dr.abs(self.tan), 1e-4 * wide / self.d)  # > 0, as log(1 + growth) divides
        growth = epsilon * pi / 2 * tan / (lipschitz + tan)
        decades = dr.maximum(dr.log(wide / narrow), tan * self.d / wide)
        return 2 + decades / dr.log(1 + growth)


def make_light_cone(
    point: JitVector, light: JitVector, radius: JitFloat, ball: JitFloat
) -> LightCone:
    """Return the cone from the ball of radius `ball` around `point` to a spherical light.

    Where one ball contains the other, the light is all around, and the cone is nearly a half-space.

    light, radius : the light's centre and radius.
    """
    across = light - point
    d = dr.norm(across)
    Float = type(d)
    r_0, r_1 = Float(ball), Float(radius)
    sin = dr.clip((r_1 - r_0) / d, -LARGEST_SINE, LARGEST_SINE)
    cos = dr.sqrt(1 - sin * sin)
    return LightCone(point, across / d, d, r_0 / cos, r_1 / cos)
