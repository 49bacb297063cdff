"""`linear`: R_C lies a constant below R_T, so that τ is needed only at the end; the default.

[Bálint et al. 2019, algorithm 4]
"""

from math import pi

import drjit as dr

from brdfkit.distance_fields.shadows.march import Rule
from brdfkit.distance_fields.shadows.shadow import single_ray
from brdfkit.distance_fields.shadows.tau import tau, tau_inverse


def discrete(field, cone, epsilon=1 / 20, direction="A"):
    """The `Shadow`: |visible - τ(r_min)| ≤ ε, and visible is 1 less a multiple of ε.

    Its `t` is where the last level was passed, which may be far from the minimum, so that its
    derivatives are rough.
    """

    def lower(ratio, R_T):
        """One level down; several where the light itself lies within an object."""
        levels = dr.maximum(dr.ceil((tau(R_T) - tau(ratio)) / epsilon - 1), 1)
        share = tau(R_T) - levels * epsilon
        return tau_inverse(share), tau_inverse(share - epsilon)

    rule = Rule((1.0, tau_inverse(1 - epsilon)), lower, tau_inverse(epsilon))
    return single_ray(field, cone, rule, epsilon, direction)


def base(field, cone, epsilon=1 / 20, direction="A"):
    """The `Shadow`: 0 ≤ visible - τ(r_min) ≤ ε."""

    def lower(ratio, R_T):
        return ratio, tau_inverse(tau(ratio) - epsilon)

    rule = Rule((1.0, tau_inverse(1 - epsilon)), lower, tau_inverse(epsilon))
    return single_ray(field, cone, rule, epsilon, direction)


def linear(field, cone, epsilon=1 / 20, direction="A"):
    """The `Shadow`: 0 ≤ visible - τ(r_min) ≤ ε."""
    return single_ray(field, cone, linear_rule(epsilon), epsilon, direction)


def linear_rule(epsilon):
    """A change of ε in τ is one of e = ε π / 2 in r at least, because τ' ≤ 2 / π."""
    e = epsilon * pi / 2
    return Rule((1.0, 1 - e), lambda ratio, R_T: (ratio, ratio - e), e - 1)


def hard(field, cone, epsilon=1 / 20, direction="A"):
    """The `Shadow` of `linear` for a light of radius 0."""
    return linear(field, cone.to_point(), epsilon, direction)
