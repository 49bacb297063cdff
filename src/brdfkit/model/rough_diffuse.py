"""The two terms of EON, a rough diffuse surface that conserves energy [Portsmouth et al. 2025].

The first is the light that matt facets scatter once, the second what they scatter to each other.
The page of the model `eon` has the formulas. Both are for white facets; `roughness` is 0 to 1.
"""

import math

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import dot

C1, C2 = 1 / 2 - 2 / (3 * math.pi), 2 / 3 - 28 / (15 * math.pi)


def scatter_once(wi: JitVector, wo: JitVector, roughness: JitFloat) -> JitFloat:
    """Return the BRDF of light that facets scatter once; the albedo of a facet is its factor."""
    s = dot(wi, wo) - wi.z * wo.z
    t = dr.select(s > 0, dr.maximum(wi.z, wo.z), 1)
    return _facet_factor(roughness) * (1 + roughness * s / t) / dr.pi


def scatter_often(wi: JitVector, wo: JitVector, roughness: JitFloat) -> JitFloat:
    """Return the BRDF of light that facets scatter twice or more often, for white facets."""
    # The common factor r A of 1 - E and 1 - Ē is cancelled from the formula's fraction
    lost = _lost_albedo(wi.z) * _lost_albedo(wo.z)
    return roughness * _facet_factor(roughness) * lost / ((C1 - C2) * dr.pi)


def _facet_factor(roughness: JitFloat) -> JitFloat:
    """Return A of the formula."""
    return 1 / (1 + C1 * roughness)


def _lost_albedo(cosine: JitFloat) -> JitFloat:
    """Return the share of light that facets scatter again, divided by r A of the formula.

    This is (1 - E) / (r A) = c₁ - G/π, for a direction with this `cosine` to the normal.
    """
    sine = dr.sqrt(dr.maximum(1 - cosine * cosine, 1e-14))
    grazing = sine * cosine * (1 + sine + sine * sine) / (1 + sine)  # tanθ (1 - sin³θ), no 0/0
    G = sine * (dr.safe_acos(cosine) - sine * cosine) + 2 / 3 * (grazing - sine)
    return C1 - G / dr.pi
