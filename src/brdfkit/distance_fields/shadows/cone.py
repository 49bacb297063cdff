"""The cone of light: it touches a ball about the surface point and the ball of the light.

    sin α = (r_1 - r_0) / d,    R_i = r_i / cos α,    ρ(t) = R_0 + t tan α

d is the distance of the balls' centres, R_0 and R_1 the radii of the cone's sections there. The
ball about the surface point is empty of objects and about as large as a pixel; a march that starts
with it needs no small first steps, and its shadows have no edge that is finer than a pixel.

[Bálint et al. 2019, section 4.1]
"""

from dataclasses import dataclass, field, replace
from math import pi
from typing import Any

import drjit as dr

NESTED = 0.999  # sin α at most: of balls that lie within each other there is no cone
POINT = 1e-6  # the radius of a section at which a cone ends in a point, over its length
TIP = 1e-3  # a cone that ends in a point is searched until it is as narrow as this, over its widest


@dataclass(frozen=True)
class LightCone:
    """A truncated cone from `start` along the unit vector `axis`, with radii R_0 and R_1.

    start, axis : points and vectors of Dr.Jit, of any backend and precision.
    d : Float, the length of the axis.
    R_0, R_1 : Float, the radii of the sections at its start and its end.
    tan : Float, tan α.
    basis : unit vectors a and b that span the sections.
    """

    start: Any
    axis: Any
    d: Any
    R_0: Any
    R_1: Any
    tan: Any = field(init=False)
    basis: tuple[Any, Any] = field(init=False)

    def __post_init__(self):
        # At once: what is first computed within a loop of Dr.Jit's must not be used behind it
        z = dr.abs(self.axis.z) > 0.5
        side = type(self.axis)(dr.select(z, 1, 0), 0, dr.select(z, 0, 1))
        a = dr.normalize(side - self.axis * dr.dot(side, self.axis))
        object.__setattr__(self, "tan", (self.R_1 - self.R_0) / self.d)
        object.__setattr__(self, "basis", (a, dr.cross(self.axis, a)))

    def radius(self, t):
        """ρ(t), the radius of the section at t; never 0, so that ratios are finite."""
        return dr.maximum(self.R_0 + t * self.tan, POINT * self.d)

    def point(self, t):
        """s(t), the point of the axis at t."""
        return self.start + self.axis * t

    def across(self, t, x, y):
        """The point at (x, y) of the section at t, whose edge is the unit circle."""
        a, b = self.basis
        return self.point(t) + (a * x + b * y) * self.radius(t)

    def disc(self, point):
        """Where the line to a `point` through the apex crosses any section: (x, y) as `across`."""
        a, b = self.basis
        offset = point - self.start
        radius = self.radius(dr.dot(offset, self.axis))
        return dr.dot(offset, a) / radius, dr.dot(offset, b) / radius

    def reversed(self):
        """The same cone from its other end."""
        return LightCone(self.point(self.d), -self.axis, self.d, self.R_1, self.R_0)

    def to_point(self):
        """The cone to the centre of the light alone."""
        return replace(self, R_1=0 * self.R_1)

    def detached(self):
        """The same cone without derivatives."""
        fields = self.start, self.axis, self.d, self.R_0, self.R_1
        return LightCone(*(dr.detach(field) for field in fields))

    def most_steps(self, epsilon, lipschitz=1.0):
        """i_max: no march of this `epsilon` takes more steps, wherever the objects are.

        A step is at least e ρ / (Lip + |tan α|) long, e = ε π / 2.
        """
        wide = dr.maximum(self.R_0, self.R_1)
        narrow = dr.maximum(dr.minimum(self.R_0, self.R_1), TIP * wide)
        tan = dr.maximum(dr.abs(self.tan), 1e-4 * wide / self.d)  # a cylinder is the limit
        growth = epsilon * pi / 2 * tan / (lipschitz + tan)
        decades = dr.maximum(dr.log(wide / narrow), tan * self.d / wide)
        return 2 + decades / dr.log(1 + growth)


def light_cone(point, light, radius, ball):
    """The `LightCone` of a ball about `point` and a light about `light`, of radius `radius`.

    Where one ball holds the other, the light is all around, and the cone is nearly a half-space.
    """
    across = light - point
    d = dr.norm(across)
    Float = type(d)
    r_0, r_1 = Float(ball), Float(radius)
    sin = dr.clip((r_1 - r_0) / d, -NESTED, NESTED)
    cos = dr.sqrt(1 - sin * sin)
    return LightCone(point, across / d, d, r_0 / cos, r_1 / cos)
