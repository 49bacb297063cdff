"""Koenderink: a sum of Zernike polynomials over both hemispheres, whose parameters are all linear.

    isotropic    f = Σ a_nml I_nml,
                 I_nml = 1/2π √((n+1)(m+1)/A) cos lΔφ
                         · [R_n^l(ρ_i) R_m^l(ρ_r) + R_m^l(ρ_i) R_n^l(ρ_r)]
    anisotropic  f = Σ a_nkml H_nkml,
                 H_nkml = [K_n^k(i) K_m^l(r) + K_n^k(r) K_m^l(i)] / √(2 + 2δ_nm δ_kl)

The weights a multiply basis functions I or H, which the indices n, k, m and l number. The
directions of light (i) and view (r) have the angle θ to the normal and the azimuth φ.
Δφ = φ_i - φ_r, ρ = √2 sin(θ/2), and R are Zernike's radial polynomials; δ is 1 for equal indices,
else 0. A = (1 if l > 0 else 2)(1 if n ≠ m else 2). The basis of one hemisphere is K_n^l =
√((n+1)/2π) R_n^|l|(ρ) {√2 cos lφ, 1, √2 sin |l|φ}, for l > 0, l = 0 and l < 0. The sum is over m ≤
n ≤ `order` with n - l even. The orders 2, 4 and 8 have 5, 14 and 55 isotropic weights, and 21, 120
and 1035 anisotropic ones. Order 0 is Lambert's model with a_0_0_0 = 2 k_d. Weights may be negative;
a sum below 0 is clamped at 0.

[Koenderink et al. 1996]; [Koenderink & van Doorn 1998]; [Kurt 2007, section 3.1]. It suits rough,
diffuse and retro-reflecting surfaces; a highlight would need infinitely many terms.
"""

import math
from collections.abc import Callable
from functools import cache
from math import factorial

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model import Model, Parameter, option, weight
from brdfkit.model.lobes import Cosine, Lobe

# The ball in the picture on the model's page: a fit to a cloth of the Burley model
PICTURE = {
    "a_0_0_0": [1.006, 0.179, 0.268],
    "a_1_1_1": [0.091, 0.016, 0.024],
    "a_2_0_0": [0.065, 0.012, 0.017],
    "a_2_2_0": [-0.013, -0.002, -0.003],
    "a_2_2_2": [-0.0035, -0.0006, -0.0009],
}


def isotropic_term(n: int, m: int, l: int, wi: JitVector, wo: JitVector) -> JitFloat:
    """Return Koenderink's isotropic basis function I_nml [sr⁻¹] at two directions.

    It is smooth at the normal, where azimuths are undefined.
    """
    a = (1 if l > 0 else 2) * (1 if n != m else 2)
    i, r = map_to_disc(wi), map_to_disc(wo)
    # (ρ_i ρ_r)^l cos lΔφ is the real part of ((x_i + i y_i)(x_r - i y_r))^l, by a recurrence
    re, square = i[0] * r[0] + i[1] * r[1], i[2] * r[2]
    harmonic, before = (re, 1.0) if l > 0 else (1.0, None)
    for _ in range(l - 1):
        harmonic, before = 2 * re * harmonic - square * before, harmonic
    radial = radial_polynomial(n, l, i[2]) * radial_polynomial(m, l, r[2])
    radial += radial_polynomial(m, l, i[2]) * radial_polynomial(n, l, r[2])
    return math.sqrt((n + 1) * (m + 1) / a) / (2 * math.pi) * radial * harmonic


def anisotropic_term(n: int, k: int, m: int, l: int, wi: JitVector, wo: JitVector) -> JitFloat:
    """Return Koenderink's anisotropic basis function H_nkml [sr⁻¹] at two directions."""
    both = hemisphere_function(n, k, wi) * hemisphere_function(m, l, wo)
    both += hemisphere_function(n, k, wo) * hemisphere_function(m, l, wi)
    return both / math.sqrt(4 if (n, k) == (m, l) else 2)


def hemisphere_function(n: int, l: int, w: JitVector) -> JitFloat:
    """Return the function K_n^l of Zernike's basis on the hemisphere, at the direction `w`."""
    x, y, square = map_to_disc(w)
    re, im = 1.0, 0.0
    for _ in range(abs(l)):
        re, im = re * x - im * y, re * y + im * x
    azimuth = 1.0 if l == 0 else math.sqrt(2) * (re if l > 0 else im)
    return math.sqrt((n + 1) / (2 * math.pi)) * radial_polynomial(n, abs(l), square) * azimuth


def map_to_disc(w: JitVector) -> tuple[JitFloat, JitFloat, JitFloat]:
    """Map a direction to the unit disc, preserving areas; return (x, y, ρ² = x² + y²) there."""
    s = dr.rsqrt(1 + w.z)
    return w.x * s, w.y * s, 1 - w.z


def radial_polynomial(n: int, l: int, square: JitFloat) -> JitFloat:
    """Return Zernike's radial polynomial R_n^l(ρ) divided by ρ^l, a polynomial in ρ² = `square`."""
    value = 0.0
    for c in _list_radial_coefficients(n, l):
        value = value * square + c
    return value


@cache
def _list_radial_coefficients(n: int, l: int) -> list[float]:
    """Return the coefficients of ρ^(n-l), ρ^(n-l-2), ..., 1 in Zernike's R_n^l(ρ) / ρ^l."""
    return [
        (-1) ** s
        * factorial(n - s)
        / (factorial(s) * factorial((n + l) // 2 - s) * factorial((n - l) // 2 - s))
        for s in range((n - l) // 2 + 1)
    ]


@cache
def _list_isotropic_indices(order: int) -> list[tuple[int, ...]]:
    """Return the indices (n, m, l) of the isotropic basis functions up to an order."""
    return [
        (n, m, l)
        for n in range(order + 1)
        for m in range(n % 2, n + 1, 2)
        for l in range(m % 2, m + 1, 2)
    ]


@cache
def _list_anisotropic_indices(order: int) -> list[tuple[int, ...]]:
    """Return the indices (n, k, m, l) of the anisotropic basis functions up to an order."""
    modes = [(n, l) for n in range(order + 1) for l in range(-n, n + 1, 2)]
    return [(*a, *b) for j, a in enumerate(modes) for b in modes[: j + 1]]


def _make_lobe(term: Callable[..., JitFloat], index: tuple[int, ...], cosine: Cosine) -> Lobe:
    """Make the lobe of the basis function `term` with this index.

    Directions are drawn from a lobe that is chosen by its energy. Only the constant function has an
    energy above 0.
    """
    constant = not any(index)
    albedo = 0.5 if constant else 0.0
    return Lobe(lambda wi, wo: term(*index, wi, wo), cosine, energy=lambda wi: albedo, diffuse=True)


class Koenderink(Model):
    order = option(2, tuple(range(17)), "N, the highest degree of the polynomials")
    symmetry = option(
        "isotropic", ("isotropic", "anisotropic"), "whether f changes as the surface turns"
    )

    @classmethod
    def is_anisotropic(cls) -> bool:
        return cls.symmetry == "anisotropic"

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter | None]:
        return {
            "a_" + "_".join(str(k).replace("-", "m") for k in index): weight(
                float(not any(index)), f"weight of the term {index}", (-math.inf, math.inf)
            )
            for index in cls.list_indices()
        }

    @classmethod
    def list_indices(cls) -> list[tuple[int, ...]]:
        """Return the indices of all terms: (n, m, l), or (n, k, m, l) if it is anisotropic."""
        list_terms = (
            _list_isotropic_indices if cls.symmetry == "isotropic" else _list_anisotropic_indices
        )
        return list_terms(cls.order)

    def lobes(self) -> tuple[Lobe, ...]:
        term = isotropic_term if self.symmetry == "isotropic" else anisotropic_term
        cosine = Cosine()
        return tuple(_make_lobe(term, index, cosine) for index in self.list_indices())
