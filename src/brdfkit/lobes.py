"""Lobes, the terms of a model, and the ways to draw their outgoing direction.

A way to draw answers `sample(wi, u)` → wo for a point `u` of the unit square, and its density
`pdf(wi, wo)` [sr⁻¹]. A direction drawn below the surface gets weight 0 from the adapter; `pdf`
is asked only for directions above it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.microfacet import dot, half_vector, reflect


@dataclass(frozen=True)
class Lobe:
    """One term of a model, without its weight.

    `eval(wi, wo)`: value in sr⁻¹ without cosine, both directions above the surface;
    `sampling`: a way to draw `wo`; `energy`: about how much light the lobe
    reflects for weight 1, by which it is chosen; `diffuse`: Mitsuba's kind of the lobe.
    """

    eval: Callable
    sampling: Any
    energy: float = 1.0
    diffuse: bool = False


def lambertian():
    """The diffuse lobe of all models: 1/π. Kurt 2007, eq. 3.1."""
    return Lobe(lambda wi, wo: 1 / dr.pi, Cosine(), diffuse=True)


@dataclass(frozen=True)
class Cosine:
    """Proportional to the cosine: Kurt 2007, eqs. 4.21, 4.22."""

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
        h = half_vector(wi, wo)
        return self.distribution.pdf(wi, h) / (4 * dot(wi, h))
