"""Chebyshev's one-sided inequality: the most light that two moments of the occluders' depth allow.

    P(X ≥ t) ≤ p_max(t) = σ² / (σ² + (t - μ)²) for t > μ, else 1;   μ = E(X), σ² = E(X²) - μ²

[Donnelly & Lauritzen 2006], [Ergun 2008, 2.2.1.4]
"""

import drjit as dr


def most_lit(mean, mean_square, t, least_variance=0.0):
    """p_max of a receiver at the depth t; exact where X has two values, of which one is t.

    least_variance : of σ², against rounding, and for the slant of a texel.
    """
    variance = dr.maximum(mean_square - mean * mean, least_variance)
    behind = t - mean
    return dr.select(behind > 0, variance / (variance + behind * behind), 1)
