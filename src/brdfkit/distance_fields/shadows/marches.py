"""`linear`: R_C lies a constant below R_T, so that τ is needed only at the end; the default.

[Bálint et al. 2019, algorithm 4]
"""

from math import pi

from brdfkit.distance_fields.shadows.march import Rule
from brdfkit.distance_fields.shadows.shadow import single_ray


def linear(field, cone, epsilon=1 / 20, direction="A"):
    """The `Shadow`: 0 ≤ visible - τ(r_min) ≤ ε."""
    return single_ray(field, cone, linear_rule(epsilon), epsilon, direction)


def linear_rule(epsilon):
    """A change of ε in τ is one of e = ε π / 2 in r at least, because τ' ≤ 2 / π."""
    e = epsilon * pi / 2
    return Rule((1.0, 1 - e), lambda ratio, R_T: (ratio, ratio - e), e - 1)
