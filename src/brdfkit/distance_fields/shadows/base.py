"""`base`: R_C is where the lit share is ε less than at R_T.

[Bálint et al. 2019, algorithm 3]
"""

from brdfkit.distance_fields.shadows.march import Rule
from brdfkit.distance_fields.shadows.shadow import single_ray
from brdfkit.distance_fields.shadows.tau import tau, tau_inverse


def base(field, cone, epsilon=1 / 20, direction="A"):
    """The `Shadow`: 0 ≤ visible - τ(r_min) ≤ ε."""

    def lower(ratio, R_T):
        return ratio, tau_inverse(tau(ratio) - epsilon)

    rule = Rule((1.0, tau_inverse(1 - epsilon)), lower, tau_inverse(epsilon))
    return single_ray(field, cone, rule, epsilon, direction)
