"""Lobes, the terms of a BRDF model, and methods that draw their outgoing directions."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import cos_theta_d, half_vector, one_minus_dot, reflect
from brdfkit.model.microfacet import CosinePower
from brdfkit.model.numerics import cosine_power


class Sampling(Protocol):
    """The interface of objects that draw outgoing directions `wo` of a lobe, given `wi`."""

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        """Draw an outgoing direction `wo`, by a random point `u` (x, y, z) of the unit cube.

        The unit vector may point below the surface; the renderer then gives it the weight 0.
        """

    def pdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        """Return the density per solid angle [sr⁻¹] with which `sample` draws `wo`.

        `wo` is above the surface. The integral of the density over the hemisphere is 1, less the
        share of samples below the surface.
        """


@dataclass(frozen=True)
class Lobe:
    """One term of a model's sum, without its weight.

    `eval`: function (wi, wo) → value in sr⁻¹, without cosine, for directions above the surface.
    `sampling`: draws `wo`; lobes with the same object are drawn together.
    `energy`: function wi → approximate albedo; a lobe is chosen in proportion to weight · energy.
    `quadratic`: function (wi, wo) → value that is multiplied by the square of the weight, such as
    light that is scattered twice.
    `diffuse`: whether Mitsuba counts the lobe as diffuse, not as glossy.
    `factors`: the two functions whose product is `eval`, if `make_factored_lobe` made the lobe.
    `parts`: the lobes whose sum it is, if `add_lobes` made it; a renderer draws each by itself.
    """

    eval: Callable[..., Any]
    sampling: Sampling
    energy: Callable[..., Any] = lambda wi: 1.0
    quadratic: Callable[..., Any] | None = None
    diffuse: bool = False
    factors: tuple[Callable[..., Any], Callable[..., Any]] | None = None
    parts: tuple[Any, ...] = ()


def make_factored_lobe(
    facets: Callable[[Any, Any], Any],
    geometry: Callable[[Any, Any], Any],
    sampling: Sampling,
    energy: Callable[[Any], Any] = lambda wi: 1.0,
) -> Lobe:
    """Make the lobe `facets(h, cos_d)` · `geometry(wi, wo)` from its two factors.

    h is the half vector and cos_d = wi·h. `sampling` and `energy` are those of `Lobe`. The factors
    make fits to tables faster: if only `facets` depends on the shape parameters, a fit sums the
    other factor just once over the cells with the same h and cos_d.
    """

    def lobe_value(wi: JitVector, wo: JitVector) -> JitFloat:
        return facets(half_vector(wi, wo), cos_theta_d(wi, wo)) * geometry(wi, wo)

    return Lobe(lobe_value, sampling, energy, factors=(facets, geometry))


def add_lobes(*parts: Lobe) -> Lobe:
    """Make one lobe of several that have the same weight, such as a base colour's.

    It is diffuse if the first one is.
    """
    quadratic = [part.quadratic for part in parts if part.quadratic]
    return Lobe(
        lambda wi, wo: sum(part.eval(wi, wo) for part in parts),
        parts[0].sampling,
        lambda wi: sum(part.energy(wi) for part in parts),
        (lambda wi, wo: sum(q(wi, wo) for q in quadratic)) if quadratic else None,
        diffuse=parts[0].diffuse,
        parts=parts,
    )


def group_components(lobes: Sequence[Lobe]) -> list[list[int]]:
    """Group the indices of lobes into Mitsuba's components: lobes that share one `sampling`."""
    groups: dict[int, list[int]] = {}
    for index, lobe in enumerate(lobes):
        groups.setdefault(id(lobe.sampling), []).append(index)
    return list(groups.values())


def lambertian() -> Lobe:
    """Make the diffuse lobe of most models, whose value is 1/π [Kurt 2007, eq. 3.1]."""
    return Lobe(lambda wi, wo: 1 / dr.pi, Cosine(), diffuse=True)


@dataclass(frozen=True)
class Cosine:
    """Sampling of directions in proportion to their cosine to the normal.

    [Kurt 2007, eqs. 4.21, 4.22]
    """

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        radius = dr.sqrt(u.x)
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        return type(wi)(radius * cos_phi, radius * sin_phi, dr.sqrt(dr.maximum(1 - u.x, 1e-12)))

    def pdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return wo.z / dr.pi


@dataclass(frozen=True)
class HalfVector:
    """Sampling of directions by reflecting wi about a normal drawn from a `distribution`."""

    distribution: Any

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        return reflect(wi, self.distribution.sample(wi, u))

    def pdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        cos_d = cos_theta_d(wi, wo)
        return self.distribution.pdf(wi, half_vector(wi, wo), cos_d) / (4 * cos_d)


@dataclass(frozen=True)
class PowerLobe:
    """Sampling of directions in proportion to cosⁿ of their angle to the lobe's `axis(wi)`.

    `exponent` is n. A direction below the surface is mirrored to above it.
    [Lafortune & Willems 1994]
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
        """Return the approximate albedo ∫ (n + 2) / 2π cosⁿα cosθ dω of a lobe about the axis.

        α is the angle to the axis, θ the angle to the normal. The albedo is close to the cosine of
        the axis to the normal; for an axis at the horizon it is 0.4 / √(n + 0.6).
        """
        z = self.axis(wi).z
        return 0.5 * (z + dr.sqrt(z * z + 0.64 / (self.exponent + 0.6)))
