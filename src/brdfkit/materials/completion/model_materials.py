"""Draws random materials of microfacet models, for a prior that needs no measured files.

A material is a diffuse term, two or three highlights, and now and then a lobe back to the light. A
highlight is that of a microfacet model,

    f = (peak / (4 cosθi cosθo)) D G F,    D = (1 + u)^-c,    u ∝ tan²θh,

where c = 2 is GGX and a large c approaches Beckmann. Real highlights are no exact models, so D may
change its width and F its rise with θd, G may be a power of the cosines, the growth by 1/cosθ may
end before the horizon, and the apertures of an instrument may widen D. Widths, strengths and
albedos are drawn evenly in their logarithms. The ranges were chosen by half of 80 reconstructed, 30
painted and 15 other measured materials; the materials themselves are no part of the prior.
"""

from dataclasses import dataclass
from functools import cache
from math import pi

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import to_half_difference
from brdfkit.materials.completion.prior_cells import get_cells

METALS = 0.2  # the share of materials that are metals
THIRD_HIGHLIGHT, BACK_LOBE, BLUR = 0.2, 0.15, 0.45  # the shares of materials that have these
POWERS_OF_COSINES = 0.8  # the share of highlights whose G is a power of the cosines
BOUNDED = 0.5  # the share of highlights whose growth towards the horizon ends before it
BOUNDS = 0.1, 1.0  # the cosines of θ at which it ends
ALBEDOS = 0.001, 0.95
METAL_ALBEDOS = 0.001, 0.1  # of the diffuse term
WIDTHS = 0.002, 0.5  # half widths at half maximum in tanθh of the narrowest highlight
WIDER = 1.3, 10.0  # the factors from its width to those of the others
EXPONENTS = 1.0, 4.0  # c
STRENGTHS, OTHER_STRENGTHS = (0.03, 1.0), (0.01, 1.0)  # of the narrowest highlight, and the others
APERTURES = 0.001, 0.01  # [rad]
RISE, WIDENING = 1.0, 0.4  # standard deviations of the exponents of F and of D with θd
LARGEST = 1e6  # largest value [sr⁻¹]


@dataclass(frozen=True)
class CellAngles:
    """Functions of the directions of all kept cells, (CELLS,) each.

    `cos_i`, `cos_o`, `cos_d`: cosines of θi, θo and θd. `log_i_o`: ln cosθi cosθo. `tangent`:
    tan²θh. `along`, `across`: cos²φd and sin²φd. `incident`, `outgoing`: tan²θi and tan²θo.
    `forward`: max(0, cos(φi - φo)) sinθi sinθo / max(cosθi, cosθo).
    """

    cos_i: FloatArray
    cos_o: FloatArray
    cos_d: FloatArray
    log_i_o: FloatArray
    tangent: FloatArray
    along: FloatArray
    across: FloatArray
    incident: FloatArray
    outgoing: FloatArray
    forward: FloatArray


@cache
def get_cell_angles() -> CellAngles:
    """Return the angles of all kept cells."""
    cells = get_cells()
    wi, wo = cells.wi, cells.wo
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    cos_i, cos_o = (np.maximum(w[:, 2], 1e-3) for w in (wi, wo))
    horizontal = np.sum(wi[:, :2] * wo[:, :2], axis=1)
    return CellAngles(
        cos_i,
        cos_o,
        np.cos(theta_d),
        np.log(cos_i * cos_o),
        np.tan(theta_h) ** 2,
        np.cos(phi_d) ** 2,
        np.sin(phi_d) ** 2,
        1 / cos_i**2 - 1,
        1 / cos_o**2 - 1,
        np.maximum(horizontal, 0) / np.maximum(cos_i, cos_o),
    )


def draw_material(rng: np.random.Generator) -> FloatArray:
    """Return the BRDF (CELLS,) [sr⁻¹] of a random material of one channel."""
    at, metal = get_cell_angles(), bool(rng.random() < METALS)
    values = draw_diffuse(rng, at, draw_log(rng, *(METAL_ALBEDOS if metal else ALBEDOS)))
    f0 = rng.uniform(0.2, 0.98) if metal else draw_log(rng, 0.02, 0.12)
    narrowest = draw_log(rng, *WIDTHS)
    aperture = draw_log(rng, *APERTURES) if rng.random() < BLUR else 0.0
    highlights = [(narrowest, draw_log(rng, *STRENGTHS))]
    for _ in range(2 if rng.random() < THIRD_HIGHLIGHT else 1):
        width = min(narrowest * draw_log(rng, *WIDER), 1.0)
        highlights.append((width, draw_log(rng, *OTHER_STRENGTHS)))
    for width, strength in highlights:
        values = values + strength * draw_highlight(rng, at, width, f0, aperture)
    if rng.random() < BACK_LOBE:
        cosine = np.clip(2 * at.cos_d**2 - 1, 0, 1)  # of the angle from wi to wo
        values = values + draw_log(rng, 0.003, 0.1) * cosine ** draw_log(rng, 1.0, 30.0)
    return np.minimum(values, LARGEST)


def draw_diffuse(rng: np.random.Generator, at: CellAngles, albedo: float) -> FloatArray:
    """Return a diffuse term: Lambert's, Oren and Nayar's, or Burley's, one as likely as another."""
    model = rng.integers(3)
    flat: FloatArray = np.full(len(at.cos_d), albedo / pi)
    if model == 0:
        return flat
    if model == 1:
        square = rng.uniform(0, 0.8) ** 2
        return flat * (
            1 - 0.5 * square / (square + 0.33) + 0.45 * square / (square + 0.09) * at.forward
        )
    grazing = 2 * rng.random() * at.cos_d**2 - 0.5
    return flat * (1 + grazing * (1 - at.cos_i) ** 5) * (1 + grazing * (1 - at.cos_o) ** 5)


def draw_highlight(
    rng: np.random.Generator, at: CellAngles, width: float, f0: float, aperture: float
) -> FloatArray:
    """Return a highlight with a half `width` at half maximum in tanθh, before the `aperture`.

    A cone of the half angle `aperture` [rad] widens it by aperture / cosθd across the plane of
    incidence, and by the aperture itself along it.
    """
    log_i_o = at.log_i_o
    if rng.random() < BOUNDED:
        # Measured highlights seldom grow by 1/cosθ up to the horizon
        square = draw_log(rng, *BOUNDS) ** 2
        log_i_o = 0.5 * sum(np.log((c**2 + square) / (1 + square)) for c in (at.cos_i, at.cos_o))
    exponent = draw_log(rng, *EXPONENTS)
    along = width**2 + aperture**2
    across = width**2 + (aperture / np.maximum(at.cos_d, 0.05)) ** 2
    peak = f0 / (4 * pi * np.sqrt(along * across))
    stretch = np.maximum(at.cos_d, 0.02) ** (-2 * WIDENING * rng.normal())
    u = at.tangent * (at.along / along + at.across / across) * stretch
    distribution = (1 + (2 ** (1 / exponent) - 1) * u) ** -exponent
    fresnel = (1 + (1 / f0 - 1) * (1 - at.cos_d) ** 5) * np.exp(
        RISE * rng.normal() * (1 - at.cos_d)
    )
    if rng.random() < POWERS_OF_COSINES:
        return peak * distribution * fresnel * np.exp(-rng.uniform(0, 1) * log_i_o)
    square = min(1.2 * width, 1.0) ** 2
    shadowing = 4 / (
        (1 + np.sqrt(1 + square * at.incident)) * (1 + np.sqrt(1 + square * at.outgoing))
    )
    return peak * distribution * fresnel * shadowing * np.exp(-log_i_o)


def draw_log(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a random number between `low` and `high`, evenly in its logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
