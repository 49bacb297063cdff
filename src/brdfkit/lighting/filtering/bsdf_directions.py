"""A few directions of a BSDF, each with the lobe about it that it represents, and its weight.

A constant c is subtracted from the BSDF f, for which the irradiance E is known. The N directions,
of densities p, account for the remainder:

    L = π c E + Σ (f - c) cosθ / (N p) · mean light

A matte surface is exact. Any c is unbiased, so that the smallest of a few values will do.
[Colbert & Křivánek 2007]
"""

import numpy as np

from brdfkit.core.array_types import (
    FloatArray,
    JitColour,
    JitFloat,
    JitInt,
    JitMask,
    JitVector,
    MitsubaObject,
)
from brdfkit.core.geometry.directions import from_angles
from brdfkit.lighting.filtering.scene_bsdfs import component_types
from brdfkit.mitsuba_bridge.arrays import Rows

# κ of the lobes over 2π / (solid angle of a direction). Sharper lobes leave gaps, in which a lamp
# is lost, and wider ones blur. With this value, 64 directions of Ward's lobe under a probe with
# lamps (grace) come nearest to the truth
OVERLAP = 0.15
PLASTIC = 1.32471795724474602596  # x³ = x + 1, the golden ratio of two dimensions
SPREAD_DIRECTIONS = from_angles(
    np.arccos(1 - (np.arange(8) + 0.5) / 8), 2 * np.pi / PLASTIC * np.arange(8)
)


class Directions:
    """Points of the unit cube that draw at least `count` directions for the `rays` of a pixel."""

    def __init__(self, count: int, rays: int) -> None:
        self.rays, self.per_ray = rays, -(-count // rays)
        self.count = rays * self.per_ray
        self.points = Rows(spread_points(self.count))

    def index(self, i: JitInt, si: MitsubaObject) -> JitInt:
        """Return the index of direction `i` of each ray; rays of a pixel are adjacent in `si`."""
        import drjit as dr
        import mitsuba as mi

        return i * self.rays + dr.arange(mi.UInt32, dr.width(si)) % self.rays

    def draw(
        self,
        index: JitInt,
        bsdf: MitsubaObject,
        si: MitsubaObject,
        types: int,
        constant: JitColour,
        active: JitMask = True,
    ) -> tuple[JitVector, JitFloat, JitColour]:
        """Return (direction, κ of its lobe, weight) by the components `types` minus `constant`."""
        import drjit as dr
        import mitsuba as mi

        context, u = mi.BSDFContext(), self.points.at(index, mi.Point3f)
        context.type_mask = types
        drawn, weight = bsdf.sample(context, si, u.x, mi.Point2f(u.y, u.z), active)
        # Where no direction can be drawn, any one will do, with the weight 0
        valid = active & (drawn.pdf > 0)
        wo, pdf = dr.select(valid, drawn.wo, si.wi), dr.select(valid, drawn.pdf, 1)
        # A lobe is as wide as the distance to the next direction; a mirror's has no width
        mirror = valid & mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Delta)
        kappa = dr.select(mirror, dr.inf, OVERLAP * 2 * dr.pi * self.count * pdf)
        cos = dr.maximum(wo.z * dr.sign(si.wi.z), 0)
        weight = mi.unpolarized_spectrum(weight) - constant * dr.select(mirror, 0, cos / pdf)
        return wo, kappa, mi.UnpolarizedSpectrum(dr.select(valid, weight, 0))


def split_constant(
    bsdf: MitsubaObject, si: MitsubaObject, active: JitMask, separate: bool
) -> tuple[JitColour, int, JitColour]:
    """Split BSDFs into a constant part c and a remainder; return (c, types, constant).

    The remainder is the components `types` minus `constant`. `separate` says whether the diffuse
    components are constant and evaluated separately; these are c, then.
    """
    import drjit as dr
    import mitsuba as mi

    matte, others = component_types(mi)
    if separate:
        return _eval_components(bsdf, si, mi.Vector3f(0, 0, 1), active, matte), others, 0
    c = mi.UnpolarizedSpectrum(np.inf)
    for wo in SPREAD_DIRECTIONS.tolist():
        c = dr.minimum(
            c, _eval_components(bsdf, si, mi.Vector3f(wo), active, matte | others) / wo[2]
        )
    return c, matte | others, c


def _eval_components(
    bsdf: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask, types: int
) -> JitColour:
    """Return BSDF × cosine of the components `types`, towards `wo` on the side of `si.wi`."""
    import drjit as dr
    import mitsuba as mi

    context = mi.BSDFContext()
    context.type_mask = types
    wo = mi.Vector3f(wo.x, wo.y, wo.z * dr.sign(si.wi.z))
    return mi.unpolarized_spectrum(bsdf.eval(context, si, wo, active))


def spread_points(count: int) -> FloatArray:
    """Return `count` points (count, 3) of the unit cube, evenly spread and always the same.

    Two coordinates advance by powers of the plastic number [Roberts 2018].

    >>> spread_points(2).shape
    (2, 3)
    """
    i = np.arange(count) + 0.5
    return np.stack([i / PLASTIC**2, i / count, i / PLASTIC], axis=1) % 1
