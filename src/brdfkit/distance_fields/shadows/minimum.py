"""The ratio f / ρ on the axis of a cone, and the place of its minimum near a known one."""

import drjit as dr

from brdfkit.distance_fields.shadows.field import distance_of

GOLDEN = (5**0.5 - 1) / 2


def ratio(field, cone, t):
    """f / ρ at t."""
    return distance_of(field)(cone.point(t)) / cone.radius(t)


def nearest_minimum(field, cone, t, width, steps):
    """The place of the minimum within `width` of t, by golden sections, without derivatives."""
    cone = cone.detached()

    def narrow(i, left, right):
        part = GOLDEN * (right - left)
        low, high = right - part, left + part
        lower = ratio(field, cone, low) < ratio(field, cone, high)
        return i + 1, dr.select(lower, left, low), dr.select(lower, high, right)

    with dr.suspend_grad():
        left, right = dr.maximum(t - width, 0), dr.minimum(t + width, cone.d)
        found = dr.while_loop((0 * t, left, right), lambda i, left, right: i < steps, narrow)
    _, left, right = found
    return (left + right) / 2
