"""The directional albedo of rough facets, by which renderers darken what lies below them.

    E = E₁ (F₀ + (1 - F₀) (1 - c)⁵)
    E₁ = 1 - t (1 - t) P(t, √μ, √α),   1 - c = Q(t, √μ, √α),   t = μ / (μ + α)

μ is the cosine of the direction to the normal, α the width of the slopes of Trowbridge & Reitz, and
F₀ Schlick's reflectance at normal incidence. E₁ is the albedo at F₀ = 1, shadowed by Smith's
height-correlated factor, without light that facets reflect twice. (1 - c)⁵ is the mean of
(1 - V·H)⁵ over the reflected light. `docs/tools/make_ggx_albedo.py` fitted the polynomials P and Q.
"""

from collections.abc import Sequence

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.model.microfacet import fifth_power

DEGREE = 5  # the largest sum of the powers of t, √μ and √α
# Coefficients of P and Q in the order of the powers of t, then of √μ, then of √α
LOST = (
    0.167963,
    -0.938774,
    7.01135,
    -24.452,
    37.7608,
    -12.4906,
    8.01377,
    -8.47657,
    81.2086,
    -153.992,
    40.1412,
    -5.97736,
    120.81,
    166.512,
    -8.35843,
    -203.162,
    -130.913,
    -104.483,
    104.329,
    96.131,
    -20.7281,
    1.37689,
    -49.8764,
    -92.2216,
    -30.1692,
    21.2556,
    165.88,
    159.29,
    -270.35,
    48.3957,
    86.2442,
    150.979,
    145.256,
    67.1879,
    -179.309,
    -40.9269,
    -7.54821,
    -187.185,
    87.4659,
    70.1129,
    -247.199,
    -392.726,
    -0.0338223,
    -1.22173,
    80.8661,
    67.2217,
    26.0834,
    379.887,
    48.1984,
    -13.1449,
    90.8138,
    -49.4201,
    -36.9506,
    -127.43,
    82.5455,
    16.9208,
)
RISE = (
    1.00369,
    -0.217484,
    -1.99729,
    3.93001,
    -3.16974,
    0.996402,
    -0.0188737,
    -0.328654,
    1.49945,
    -2.0893,
    0.918342,
    -0.424018,
    -1.2137,
    3.08145,
    -3.47607,
    -0.233818,
    0.179671,
    6.27621,
    -1.42503,
    -5.20042,
    1.26617,
    -0.00525318,
    0.515933,
    0.350183,
    -2.90882,
    3.5592,
    -1.336,
    1.51701,
    1.15481,
    -6.68024,
    -0.774202,
    1.69512,
    -0.477749,
    -1.38862,
    6.85991,
    -0.947279,
    0.0158136,
    2.12774,
    -2.68686,
    6.08113,
    0.624708,
    -2.57912,
    -4.72142,
    1.91266,
    -4.386,
    3.3328,
    -0.083906,
    -1.88201,
    4.19297,
    1.28053,
    2.26094,
    -2.28032,
    0.155562,
    -0.425205,
    -0.474014,
    -0.0908795,
)


def schlick_albedo(cosine: JitFloat, alpha: JitFloat, f0: JitFloat) -> JitFloat:
    """Return the directional albedo E of rough facets with the reflectance `f0` of a dielectric.

    `cosine` is that of the direction to the normal, `alpha` the width of the slopes, from 0.0016.
    The error is below 0.001.
    """
    t, s, q = cosine / (cosine + alpha), dr.sqrt(cosine), dr.sqrt(alpha)
    albedo = 1 - t * (1 - t) * _evaluate(LOST, t, s, q)
    return albedo * (f0 + (1 - f0) * fifth_power(_evaluate(RISE, t, s, q)))


def _evaluate(coefficients: Sequence[float], t: JitFloat, s: JitFloat, q: JitFloat) -> JitFloat:
    """Return a polynomial of the `DEGREE` in t, s and q, by Horner's scheme."""
    left = list(coefficients)
    in_t = []
    for i in range(DEGREE + 1):
        in_s = []
        for j in range(DEGREE + 1 - i):
            in_q = [left.pop(0) for _ in range(DEGREE + 1 - i - j)]
            in_s.append(_sum_powers(in_q, q))
        in_t.append(_sum_powers(in_s, s))
    return _sum_powers(in_t, t)


def _sum_powers(factors: Sequence[JitFloat], x: JitFloat) -> JitFloat:
    """Return Σ factor_k xᵏ."""
    total = factors[-1]
    for factor in reversed(factors[:-1]):
        total = total * x + factor
    return total
