"""`discrete`: the lit share goes down by steps of ε, whatever the ratio.

[Bálint et al. 2019, algorithm 5]
"""

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
