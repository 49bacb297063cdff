"""A few directions of a BSDF, each with the lobe about it that it stands for, and its weight.

A constant c is taken from the BSDF, for which the irradiance is known; the directions see the rest:
L = π c E + Σ (f - c) cosθ / (N p) · mean light. A matte surface is exact; any c is right, so that
the lowest of a few values will do. [Colbert & Křivánek 2007]
"""

import numpy as np

from brdfkit.core.geometry.directions import from_angles
from brdfkit.lighting.filtering.scene_bsdfs import matte_and_rest
from brdfkit.mitsuba_bridge.arrays import Rows

# κ of the lobes over 2π / (solid angle of a direction). Sharper ones leave gaps, in which a lamp is
# lost, and wider ones blur: 64 directions of Ward's lobe under a probe with lamps (grace) come
# nearest to the truth with this
OVERLAP = 0.15
PLASTIC = 1.32471795724474602596  # x³ = x + 1, the golden ratio of two dimensions
SPREAD_OUT = from_angles(
    np.arccos(1 - (np.arange(8) + 0.5) / 8), 2 * np.pi / PLASTIC * np.arange(8)
)


class Directions:
    """The numbers that draw at least `count` directions of a pixel, dealt out to its `rays`."""

    def __init__(self, count, rays):
        self.rays, self.per_ray = rays, -(-count // rays)
        self.count = rays * self.per_ray
        self.points = Rows(points(self.count))

    def place(self, i, si):
        """The number of the direction `i` of each ray; those of a pixel are adjacent in `si`."""
        import drjit as dr
        import mitsuba as mi

        return i * self.rays + dr.arange(mi.UInt32, dr.width(si)) % self.rays

    def draw(self, place, bsdf, si, types, less, active=True):
        """(direction, κ of its lobe, weight) by the components `types` less the constant `less`."""
        import drjit as dr
        import mitsuba as mi

        context, u = mi.BSDFContext(), self.points.at(place, mi.Point3f)
        context.type_mask = types
        drawn, weight = bsdf.sample(context, si, u.x, mi.Point2f(u.y, u.z), active)
        # Where none can be drawn: any direction, of no weight
        valid = active & (drawn.pdf > 0)
        wo, pdf = dr.select(valid, drawn.wo, si.wi), dr.select(valid, drawn.pdf, 1)
        # A lobe as wide as the distance to the next direction; a mirror's has no width
        mirror = valid & mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Delta)
        kappa = dr.select(mirror, dr.inf, OVERLAP * 2 * dr.pi * self.count * pdf)
        cos = dr.maximum(wo.z * dr.sign(si.wi.z), 0)
        weight = mi.unpolarized_spectrum(weight) - less * dr.select(mirror, 0, cos / pdf)
        return wo, kappa, mi.UnpolarizedSpectrum(dr.select(valid, weight, 0))


def constant_and_rest(bsdf, si, active, apart):
    """(c, types, less): a constant part c of BSDFs; the rest are the components `types`, less the
    constant `less`.

    apart : whether their diffuse components are constant, and told apart from the others.
    """
    import drjit as dr
    import mitsuba as mi

    matte, rest = matte_and_rest(mi)
    if apart:
        return _value(bsdf, si, mi.Vector3f(0, 0, 1), active, matte), rest, 0
    c = mi.UnpolarizedSpectrum(np.inf)
    for wo in SPREAD_OUT.tolist():
        c = dr.minimum(c, _value(bsdf, si, mi.Vector3f(wo), active, matte | rest) / wo[2])
    return c, matte | rest, c


def _value(bsdf, si, wo, active, types):
    """BSDF times cosine of the components of some `types`, towards `wo` on the side of `si.wi`."""
    import drjit as dr
    import mitsuba as mi

    context = mi.BSDFContext()
    context.type_mask = types
    wo = mi.Vector3f(wo.x, wo.y, wo.z * dr.sign(si.wi.z))
    return mi.unpolarized_spectrum(bsdf.eval(context, si, wo, active))


def points(count):
    """`count` points (count, 3) of the unit cube, evenly spread, the same always.

    Two coordinates advance by powers of the plastic number [Roberts 2018].

    >>> points(2).shape
    (2, 3)
    """
    i = np.arange(count) + 0.5
    return np.stack([i / PLASTIC**2, i / count, i / PLASTIC], axis=1) % 1
