"""Lobes, the terms of a model, and the ways to draw their outgoing directions."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import cos_theta_d, half_vector, one_minus_dot, reflect
from brdfkit.model.microfacet import CosinePower
from brdfkit.model.numerics import cosine_power


class Sampling(Protocol):
    """A way to draw the outgoing direction of a lobe."""

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        """Return a unit vector wo for a point `u` (x, y, z) of the unit cube.

        It may lie below the surface; the adapter gives it the weight 0.
        """

    def pdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        """Return the density of `sample` per solid angle [sr⁻¹] at `wo` above the surface.

        Its integral over the hemisphere is 1, less the share of samples below the surface.
        """


@dataclass(frozen=True)
class Lobe:
    """One term of a model, without its weight.

    `eval(wi, wo)` is the value in sr⁻¹ without cosine, for directions above the surface. `sampling`
    draws `wo`; lobes that are drawn together share one object. `energy(wi)` is about the lobe's
    albedo: lobes are chosen in proportion to weight times energy. `quadratic(wi, wo)` is a value
    that is multiplied by the square of the weight, as for light that is scattered twice. `diffuse`
    says whether Mitsuba counts the lobe as diffuse, else as glossy. `factors` are the two functions
    of a lobe from `make_factored_lobe`.
    """

    eval: Callable[..., Any]
    sampling: Sampling
    energy: Callable[..., Any] = lambda wi: 1.0
    quadratic: Callable[..., Any] | None = None
    diffuse: bool = False
    factors: tuple[Callable[..., Any], Callable[..., Any]] | None = None


def make_factored_lobe(
    facets: Callable[[Any, Any], Any],
    geometry: Callable[[Any, Any], Any],
    sampling: Sampling,
    energy: Callable[[Any], Any] = lambda wi: 1.0,
) -> Lobe:
    """Make the lobe `facets(h, cos_d)` · `geometry(wi, wo)`; h is the half vector, cos_d wi·h.

    A fit to a table with a linear loss sums over the cells once and for all if the shape parameters
    occur in `facets` alone. The fit finds out by itself whether they do.
    """

    def value(wi: JitVector, wo: JitVector) -> JitFloat:
        return facets(half_vector(wi, wo), cos_theta_d(wi, wo)) * geometry(wi, wo)

    return Lobe(value, sampling, energy, factors=(facets, geometry))


def group_components(lobes: Sequence[Lobe]) -> list[list[int]]:
    """Return the lobes' indices of each component; lobes with one sampling are one component."""
    groups: dict[int, list[int]] = {}
    for index, lobe in enumerate(lobes):
        groups.setdefault(id(lobe.sampling), []).append(index)
    return list(groups.values())


def lambertian() -> Lobe:
    """Make the diffuse lobe of most models, 1/π [Kurt 2007, eq. 3.1]."""
    return Lobe(lambda wi, wo: 1 / dr.pi, Cosine(), diffuse=True)


@dataclass(frozen=True)
class Cosine:
    """Draws directions in proportion to their cosine [Kurt 2007, eqs. 4.21, 4.22]."""

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        radius = dr.sqrt(u.x)
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        return type(wi)(radius * cos_phi, radius * sin_phi, dr.sqrt(dr.maximum(1 - u.x, 1e-12)))

    def pdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return wo.z / dr.pi


@dataclass(frozen=True)
class HalfVector:
    """Draws a half vector from a `distribution` of normals, and reflects wi about it."""

    distribution: Any

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        return reflect(wi, self.distribution.sample(wi, u))

    def pdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        cos_d = cos_theta_d(wi, wo)
        return self.distribution.pdf(wi, half_vector(wi, wo), cos_d) / (4 * cos_d)


@dataclass(frozen=True)
class PowerLobe:
    """Draws directions above the surface in proportion to cos^n of their angle to `axis(wi)`.

    A direction below the surface is mirrored up. [Lafortune & Willems 1994]
    """

    axis: Callable[..., Any]
    exponent: Any

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        about_z = CosinePower(self.exponent, self.exponent).sample(wi, u)
        wo = reflect(about_z, half_vector(type(wi)(0, 0, 1), self.axis(wi)))
        return type(wi)(wo.x, wo.y, dr.abs(wo.z))

    def pdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        axis, below = self.axis(wi), type(wo)(wo.x, wo.y, -wo.z)
        power = cosine_power(one_minus_dot(axis, wo), self.exponent)
        power += cosine_power(one_minus_dot(axis, below), self.exponent)
        return (self.exponent + 1) / (2 * dr.pi) * power

    def energy(self, wi: JitVector) -> JitFloat:
        """Return about the albedo ∫ (n + 2) / 2π cos^n cosθ dω of the lobe.

        It is close to the cosine of the axis, which is 1 at the normal; with the axis at the
        horizon it is 0.4 / √(n + 0.6).
        """
        z = self.axis(wi).z
        return 0.5 * (z + dr.sqrt(z * z + 0.64 / (self.exponent + 0.6)))
