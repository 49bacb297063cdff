"""How much of a spherical Gaussian lobe around a point is not hidden by convex parts.

The share ∫ g(ω; μ, κ) V(ω) dω of a von Mises-Fisher lobe g, as the mean of V over a few directions,
the same for every point: a spiral through the lobe, with equal probability between its points.
"""

import math

GOLDEN_ANGLE = math.pi * (3 - math.sqrt(5))


def visible_share(occluders, points, axes, kappa, rays=16):
    """The visible share, 0 to 1, of the lobes around `points`; to about 1 / rays.

    occluders : `Occluders`, or anything else with their `blocked`.
    points, axes : `mitsuba.Point3f` in the world, and the unit axes μ of the lobes.
    kappa : the concentrations κ > 0, a `mitsuba.Float`.
    rays : directions per lobe.
    """
    import drjit as dr
    import mitsuba as mi

    frame = mi.Frame3f(axes)

    def add(i, seen):
        # The inverse of the lobe's distribution of cosθ, at the middles of equal parts
        x = (mi.Float(i) + 0.5) / rays
        cos = 1 + dr.log(x + (1 - x) * dr.exp(-2 * kappa)) / kappa
        sin = dr.safe_sqrt(1 - cos * cos)
        sin_phi, cos_phi = dr.sincos(mi.Float(i) * GOLDEN_ANGLE)
        direction = frame.to_world(mi.Vector3f(sin * cos_phi, sin * sin_phi, cos))
        blocked, _ = occluders.blocked(mi.Ray3f(points, direction))
        return i + 1, seen + dr.select(blocked, 0.0, 1.0)

    count = mi.UInt32(rays)
    dr.make_opaque(count)
    _, seen = dr.while_loop(
        (dr.zeros(mi.UInt32, dr.width(points)), mi.Float(0)), lambda i, seen: i < count, add
    )
    return seen / rays
