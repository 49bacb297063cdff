"""`dense`: τ(r_min), which the marches approach, by a dense search along the axis.

What a march differs from it by is the error that ε bounds; what it differs from the light that
truly arrives by is the error of the model.

[Bálint et al. 2019, section 4.1]
"""

import drjit as dr

from brdfkit.distance_fields.shadows.shadow import Shadow, nearest_minimum, ratio
from brdfkit.distance_fields.shadows.tau import tau


def dense(field, cone, samples=2000, refinements=40):
    """The `Shadow` of the smallest of `samples` ratios, refined between its two neighbours."""
    cone = cone.detached()
    zero = 0 * cone.d
    spacing = cone.d / samples

    def look(i, r, t_min):
        here = ratio(field, cone, i * spacing)
        return i + 1, dr.minimum(r, here), dr.select(here < r, i * spacing, t_min)

    with dr.suspend_grad():
        _, r, t = dr.while_loop((zero, zero + 1, zero), lambda i, r, t: i <= samples, look)
        t = nearest_minimum(field, cone, t, spacing, refinements)
        r = dr.minimum(r, ratio(field, cone, t))
    return Shadow(tau(r), r, t, zero + samples + 2 * refinements)
