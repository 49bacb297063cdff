"""Lobes, the terms of a model, and the ways to draw their outgoing direction."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import drjit as dr

from brdfkit.geometry.vectors import cos_theta_d, half_vector, one_minus_dot, reflect
from brdfkit.model.microfacet import CosinePower
from brdfkit.model.numerics import cosine_power


class Sampling(Protocol):
    """A way to draw the outgoing direction of a lobe."""

    def sample(self, wi, u):
        """A unit vector wo for a point `u` (x, y, z) of the unit cube.

        It may lie below the surface: the adapter gives it weight 0.
        """

    def pdf(self, wi, wo):
        """Density of `sample` per solid angle [sr⁻¹], asked for `wo` above the surface only.

        Its integral over the sphere is 1, over the hemisphere less where samples fall below.
        """


@dataclass(frozen=True)
class Lobe:
    """One term of a model, without its weight.

    `eval(wi, wo)`: value in sr⁻¹ without cosine, both directions above the surface; `sampling`: a
    way to draw `wo`, one object for lobes that are drawn together; `energy(wi)`: about the lobe's
    albedo, by which it is chosen; `quadratic(wi, wo)`: a value that the square of the weight
    multiplies, where light scattered twice counts; `diffuse`: Mitsuba's kind of the lobe.
    """

    eval: Callable
    sampling: Sampling
    energy: Callable = lambda wi: 1.0
    quadratic: Callable | None = None
    diffuse: bool = False


def components_of(lobes):
    """Indices of the lobes of each component: lobes that share a sampling are one."""
    groups = {}
    for index, lobe in enumerate(lobes):
        groups.setdefault(id(lobe.sampling), []).append(index)
    return list(groups.values())


def lambertian():
    """The diffuse lobe of all models: 1/π [Kurt 2007, eq. 3.1]."""
    return Lobe(lambda wi, wo: 1 / dr.pi, Cosine(), diffuse=True)


@dataclass(frozen=True)
class Cosine:
    """Proportional to the cosine [Kurt 2007, eqs. 4.21, 4.22]."""

    def sample(self, wi, u):
        radius = dr.sqrt(u.x)
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        return type(wi)(radius * cos_phi, radius * sin_phi, dr.sqrt(dr.maximum(1 - u.x, 1e-12)))

    def pdf(self, wi, wo):
        return wo.z / dr.pi


@dataclass(frozen=True)
class HalfVector:
    """A half vector from a distribution of normals, and the mirror direction about it."""

    distribution: Any

    def sample(self, wi, u):
        return reflect(wi, self.distribution.sample(wi, u))

    def pdf(self, wi, wo):
        cos_d = cos_theta_d(wi, wo)
        return self.distribution.pdf(wi, half_vector(wi, wo), cos_d) / (4 * cos_d)


@dataclass(frozen=True)
class PowerLobe:
    """Outgoing directions by cos^n about `axis(wi)`, which is above the surface; what would fall
    below it is mirrored up.

    [Lafortune & Willems 1994]
    """

    axis: Callable
    exponent: Any

    def sample(self, wi, u):
        about_z = CosinePower(self.exponent, self.exponent).sample(wi, u)
        wo = reflect(about_z, half_vector(type(wi)(0, 0, 1), self.axis(wi)))
        return type(wi)(wo.x, wo.y, dr.abs(wo.z))

    def pdf(self, wi, wo):
        axis, below = self.axis(wi), type(wo)(wo.x, wo.y, -wo.z)
        power = cosine_power(one_minus_dot(axis, wo), self.exponent)
        power += cosine_power(one_minus_dot(axis, below), self.exponent)
        return (self.exponent + 1) / (2 * dr.pi) * power

    def energy(self, wi):
        """About ∫ (n + 2) / 2π cos^n cosθ dω over the hemisphere: 1 about the normal, towards the
        horizon the cosine of the axis, at it 0.4 / √(n + 0.6)."""
        z = self.axis(wi).z
        return 0.5 * (z + dr.sqrt(z * z + 0.64 / (self.exponent + 0.6)))
