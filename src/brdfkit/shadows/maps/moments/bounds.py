"""Upper bounds on the light at a depth t, from two or four moments of the occluders' depth X.

The depths X in the texels near a point are random, and the light that arrives is the probability
P(X ≥ t) that an occluder is not nearer than the point. A map stores only moments: means of powers
of X.

Two moments give a bound by Chebyshev's one-sided inequality [Donnelly & Lauritzen 2006], [Ergun
2008, 2.2.1.4]:

    P(X ≥ t) ≤ σ² / (σ² + (t - μ)²) for t > μ, else 1;   μ = E(X), σ² = E(X²) - μ²

Four moments b₁ = E(X) ... b₄ = E(X⁴) give a sharper one [Peters & Klein 2015]. Among all
distributions with these moments, the one with the most light has only three depths: t, z₂ and z₃.
z₂ and z₃ are the roots of c₁ + c₂ z + c₃ z² with

    | 1  b₁ b₂ |       | 1  |
    | b₁ b₂ b₃ | · c = | t  |
    | b₂ b₃ b₄ |       | t² |
"""

from collections.abc import Sequence

import drjit as dr

from brdfkit.core.array_types import JitFloat

# Moments E(X) ... E(X⁴) of depths in [-1, 1] that stay valid if all four change a little: mixed in,
# they make moments with rounding errors valid again [Münstermann et al. 2018]
MIDDLE_MOMENTS = 0.0, 0.375, 0.0, 0.375
# Smallest c₃ / c₂ of the quadratic c₁ + c₂ z + c₃ z²; below it, a root would overflow
LEAST_ROOT = 1e-7


def bound_by_two_moments(
    mean: JitFloat, mean_square: JitFloat, t: JitFloat, least_variance: JitFloat = 0.0
) -> JitFloat:
    """Return the largest share of light at depth t, P(X ≥ t), that two moments of depth X allow.

    It is exact if the depth X of the occluders has two values, one of them t.

    mean, mean_square : the moments E(X) and E(X²).
    least_variance : smallest variance of X to assume, as rounding may make it too small.
    """
    variance = dr.maximum(mean_square - mean * mean, least_variance)
    behind = t - mean
    return dr.select(behind > 0, variance / (variance + behind * behind), 1)


def bound_by_four_moments(b: Sequence[JitFloat], t: JitFloat, rounding: float = 0.0) -> JitFloat:
    """Return the largest share of light at depth t, P(X ≥ t), that four moments of depth X allow.

    It is exact if the depth X of the occluders has two values, or three with t among them.

    b : the moments E(X), E(X²), E(X³) and E(X⁴).
    rounding : share, 0 to 1, of `MIDDLE_MOMENTS` that is mixed in, as moments with rounding errors
        may belong to no distribution.
    """
    b1, b2, b3, b4 = (
        (1 - rounding) * own + rounding * middle
        for own, middle in zip(b, MIDDLE_MOMENTS, strict=True)
    )

    # Solve B c = (1, t, t²), with the matrix B of moments in the file's docstring, by the factors
    # B = L D Lᵀ: D is diagonal with 1, d2, d3, and L lower triangular with 1 on the diagonal
    d2 = b2 - b1 * b1
    l32 = (b3 - b1 * b2) / d2
    d3 = b4 - b2 * b2 - l32 * l32 * d2
    y2 = t - b1
    y3 = t * t - b2 - l32 * y2
    c3 = y3 / d3
    c2 = y2 / d2 - l32 * c3
    c1 = 1 - b1 * c2 - b2 * c3

    c3 = dr.mulsign(dr.maximum(dr.abs(c3), LEAST_ROOT * dr.abs(c2)), c3)
    p, q = c2 / c3, c1 / c3
    root = dr.sqrt(dr.maximum(p * p / 4 - q, 0))
    z2, z3 = -p / 2 - root, -p / 2 + root

    one = (t * z3 - b1 * (t + z3) + b2) / ((z3 - z2) * (t - z2))
    two = (z2 * z3 - b1 * (z2 + z3) + b2) / ((t - z2) * (t - z3))
    dark = dr.select(t <= z2, 0, dr.select(t <= z3, one, 1 - two))
    return 1 - dr.clip(dark, 0, 1)
