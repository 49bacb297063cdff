"""`aaltonen`: the rival of 2018, `quilez` with the nearest point between two steps estimated.

Two balls about successive points of the ray meet in a circle, near which the object is taken to be.

[Aaltonen 2018]
"""

import drjit as dr

from brdfkit.distance_fields.shadows.rivals import nearest_passing


def aaltonen(field, cone):
    """The `Shadow`: the smallest k √(f² - y²) / (t - y), y = f² / (2 f before)."""

    def nearness(t, F, F_before):
        y = F * F / (2 * F_before)
        return dr.safe_sqrt(F * F - y * y) / dr.maximum(t - y, 1e-6 * t)

    return nearest_passing(field, cone, nearness)
