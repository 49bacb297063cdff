"""How much of a spherical Gaussian lobe around a point is not hidden.

The share ∫ g(ω; μ, κ) L(ω) V(ω) dω / ∫ g(ω; μ, κ) L(ω) dω of a von Mises-Fisher lobe g, by a few
directions, the same for every point: a spiral through the lobe, with equal probability between its
points.
"""

import math

GOLDEN_ANGLE = math.pi * (3 - math.sqrt(5))


def visible_share(visible, axes, kappa, weight, rays=16):
    """The visible share, 0 to 1, of lobes, of each channel; to about 1 / rays.

    visible : V, a function of directions in the world, `mitsuba.Vector3f`, to `mitsuba.Bool`.
    axes : the unit axes μ of the lobes, `mitsuba.Vector3f`.
    kappa : the concentrations κ > 0, a `mitsuba.Float`.
    weight : L, a function of directions to `mitsuba.Color3f`: how much each of them counts. Where
        none counts, all is visible.
    rays : directions per lobe.
    """
    import drjit as dr
    import mitsuba as mi

    frame = mi.Frame3f(axes)

    def add(i, seen, total):
        # The inverse of the lobe's distribution of cosθ, at the middles of equal parts
        x = (mi.Float(i) + 0.5) / rays
        cos = 1 + dr.log(x + (1 - x) * dr.exp(-2 * kappa)) / kappa
        sin = dr.safe_sqrt(1 - cos * cos)
        sin_phi, cos_phi = dr.sincos(mi.Float(i) * GOLDEN_ANGLE)
        direction = frame.to_world(mi.Vector3f(sin * cos_phi, sin * sin_phi, cos))
        counted = mi.Color3f(weight(direction))
        return i + 1, seen + dr.select(visible(direction), counted, 0), total + counted

    count = mi.UInt32(rays)
    dr.make_opaque(count)
    _, seen, total = dr.while_loop(
        (mi.UInt32(0), mi.Color3f(0), mi.Color3f(0)), lambda i, seen, total: i < count, add
    )
    return dr.select(total > 0, seen / total, 1)
