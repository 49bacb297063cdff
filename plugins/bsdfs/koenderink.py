"""Koenderink: an orthonormal basis of Zernike polynomials over both hemispheres, all linear.

    isotropic    f = Σ a_nml I_nml,
                 I_nml = 1/2π √((n+1)(m+1)/A) cos lΔφ
                         · [R_n^l(ρ_i) R_m^l(ρ_r) + R_m^l(ρ_i) R_n^l(ρ_r)]
    anisotropic  f = Σ a_nkml H_nkml,
                 H_nkml = [K_n^k(i) K_m^l(r) + K_n^k(r) K_m^l(i)] / √(2 + 2δ_nm δ_kl)

with ρ = √2 sin(θ/2), A = (1 if l > 0 else 2)(1 if n ≠ m else 2), and the hemisphere's basis
K_n^l = √((n+1)/2π) R_n^|l|(ρ) {√2 cos lφ, 1, √2 sin |l|φ}; m ≤ n ≤ `order`, n - l even. The orders
2, 4 and 8 have 5, 14 and 55 isotropic weights, and 21, 120 and 1035 anisotropic ones. Order 0 is
Lambert with a_0_0_0 = 2 k_d. Weights may be negative; a sum below 0 is clamped at 0.

[Koenderink et al. 1996]; [Koenderink & van Doorn 1998]; [Kurt 2007, section 3.1]. Shows rough,
diffuse and retro-reflecting surfaces; a highlight needs infinitely many terms.
"""

import math
from functools import cache
from math import factorial

import drjit as dr

from brdfkit.model import Model, option, weight
from brdfkit.model.lobes import Cosine, Lobe

# A cloth that reflects some light back and shines at its rim: Burley's, fitted
PICTURE = {
    "a_0_0_0": [1.006, 0.179, 0.268],
    "a_1_1_1": [0.091, 0.016, 0.024],
    "a_2_0_0": [0.065, 0.012, 0.017],
    "a_2_2_0": [-0.013, -0.002, -0.003],
    "a_2_2_2": [-0.0035, -0.0006, -0.0009],
}


def isotropic_term(n, m, l, wi, wo):
    """I_nml. ρ^l cos lΔφ is the real part of a power, smooth at the normal."""
    a = (1 if l > 0 else 2) * (1 if n != m else 2)
    i, r = disc(wi), disc(wo)
    # (ρ_i ρ_r)^l cos lΔφ by the recurrence of Re u^l, u = p_i · conj(p_r)
    re, square = i[0] * r[0] + i[1] * r[1], i[2] * r[2]
    harmonic, before = (re, 1.0) if l > 0 else (1.0, None)
    for _ in range(l - 1):
        harmonic, before = 2 * re * harmonic - square * before, harmonic
    radial = radial_part(n, l, i[2]) * radial_part(m, l, r[2])
    radial += radial_part(m, l, i[2]) * radial_part(n, l, r[2])
    return math.sqrt((n + 1) * (m + 1) / a) / (2 * math.pi) * radial * harmonic


def anisotropic_term(n, k, m, l, wi, wo):
    """H_nkml."""
    both = mode(n, k, wi) * mode(m, l, wo) + mode(n, k, wo) * mode(m, l, wi)
    return both / math.sqrt(4 if (n, k) == (m, l) else 2)


def mode(n, l, w):
    """K_n^l, orthonormal over the hemisphere."""
    x, y, square = disc(w)
    re, im = 1.0, 0.0
    for _ in range(abs(l)):
        re, im = re * x - im * y, re * y + im * x
    azimuth = 1.0 if l == 0 else math.sqrt(2) * (re if l > 0 else im)
    return math.sqrt((n + 1) / (2 * math.pi)) * radial_part(n, abs(l), square) * azimuth


def disc(w):
    """(x, y, ρ²) of the equal-area image of a direction on the unit disc."""
    s = dr.rsqrt(1 + w.z)
    return w.x * s, w.y * s, 1 - w.z


def radial_part(n, l, square):
    """R_n^l(ρ) / ρ^l, a polynomial in ρ² = `square`."""
    value = 0.0
    for c in _coefficients(n, l):
        value = value * square + c
    return value


@cache
def _coefficients(n, l):
    """The coefficients of ρ^(n-l), ρ^(n-l-2), ..., 1 in `radial_part`."""
    return [
        (-1) ** s
        * factorial(n - s)
        / (factorial(s) * factorial((n + l) // 2 - s) * factorial((n - l) // 2 - s))
        for s in range((n - l) // 2 + 1)
    ]


@cache
def _isotropic(order):
    return [
        (n, m, l)
        for n in range(order + 1)
        for m in range(n % 2, n + 1, 2)
        for l in range(m % 2, m + 1, 2)
    ]


@cache
def _anisotropic(order):
    modes = [(n, l) for n in range(order + 1) for l in range(-n, n + 1, 2)]
    return [(*a, *b) for j, a in enumerate(modes) for b in modes[: j + 1]]


def _lobe(term, index, cosine):
    constant = not any(index)
    albedo = 0.5 if constant else 0.0
    return Lobe(lambda wi, wo: term(*index, wi, wo), cosine, energy=lambda wi: albedo, diffuse=True)


class Koenderink(Model):
    order = option(2, tuple(range(17)), "N, the highest degree of the polynomials")
    symmetry = option("isotropic", ("isotropic", "anisotropic"), "whether the azimuth counts")

    @classmethod
    def anisotropic(cls):
        return cls.symmetry == "anisotropic"

    @classmethod
    def more_parameters(cls):
        return {
            "a_" + "_".join(str(k).replace("-", "m") for k in index): weight(
                float(not any(index)), f"weight of the term {index}", (-math.inf, math.inf)
            )
            for index in cls.indices()
        }

    @classmethod
    def indices(cls):
        """(n, m, l) of the isotropic terms, (n, k, m, l) of the anisotropic ones."""
        return _isotropic(cls.order) if cls.symmetry == "isotropic" else _anisotropic(cls.order)

    def lobes(self):
        term = isotropic_term if self.symmetry == "isotropic" else anisotropic_term
        cosine = Cosine()
        return tuple(_lobe(term, index, cosine) for index in self.indices())
