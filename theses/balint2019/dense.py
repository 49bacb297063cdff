"""Computes the shadow τ(r_min) that all marches approach, by a dense search along the cone's axis.

The difference of a march from it is the error that ε bounds. Its own difference from the light that
truly arrives is the error of the model, one straight edge.

[Bálint et al. 2019, section 4.1]
"""

from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.shadow import Shadow, clearance_ratio, find_smallest_ratio
from brdfkit.distance_fields.shadows.tau import lit_disc_share


def compute_dense_shadow(
    field: Any, cone: LightCone, samples: int = 2000, refinements: int = 40
) -> Shadow:
    """Compute the shadow of the smallest of `samples` ratios, refined between its neighbours."""
    cone = cone.make_detached()
    zero = 0 * cone.d
    spacing = cone.d / samples

    def compare_ratio(
        i: JitFloat, r: JitFloat, t_min: JitFloat
    ) -> tuple[JitFloat, JitFloat, JitFloat]:
        here = clearance_ratio(field, cone, i * spacing)
        return i + 1, dr.minimum(r, here), dr.select(here < r, i * spacing, t_min)

    with dr.suspend_grad():
        _, r, t = dr.while_loop((zero, zero + 1, zero), lambda i, r, t: i <= samples, compare_ratio)
        t = find_smallest_ratio(field, cone, t, spacing, refinements)
        r = dr.minimum(r, clearance_ratio(field, cone, t))
    return Shadow(lit_disc_share(r), r, t, zero + samples + 2 * refinements)
