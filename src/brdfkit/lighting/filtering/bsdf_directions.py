"""Directions drawn by a BSDF for filtered importance sampling, each with a weight and a lobe.

The light from a direction is averaged over a lobe about it, which is as wide as the distance to the
next direction. The BSDF f is split into a constant c and a remainder f - c, because the irradiance
alone gives the light that the constant reflects. The reflected radiance is

    L = π c E + Σ (f - c) cosθ / (N p) · mean radiance over the lobe

where E is the irradiance divided by π. The sum is over N directions, which are drawn with the
densities p. It is exact for matte surfaces, and c does not bias it.
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
from brdfkit.lighting.filtering.scene_bsdfs import split_component_types
from brdfkit.mitsuba_bridge.arrays import Rows

# A lobe's concentration κ is this factor times 2π / (solid angle that a direction represents).
# Sharper lobes would leave gaps, in which lamps are lost, and wider ones would blur. This value
# minimises the error of 64 directions of Ward's BRDF under a light probe with lamps (grace)
OVERLAP = 0.15
# The plastic number, which solves x³ = x + 1; its powers make evenly spread sequences of points in
# two dimensions
PLASTIC = 1.32471795724474602596
SPREAD_DIRECTIONS = from_angles(
    np.arccos(1 - (np.arange(8) + 0.5) / 8), 2 * np.pi / PLASTIC * np.arange(8)
)


class Directions:
    """Random numbers by which a BSDF draws directions, the same for each pixel of a picture.

    They are at least `count` points of the unit cube, shared out among the `rays` of a pixel.
    """

    def __init__(self, count: int, rays: int) -> None:
        self.rays, self.per_ray = rays, -(-count // rays)
        self.count = rays * self.per_ray
        self.points = Rows(spread_cube_points(self.count))

    def find_direction_index(self, i: JitInt, si: MitsubaObject) -> JitInt:
        """Return the index of the `i`-th direction of each ray among all directions of its pixel.

        The rays of a pixel must be adjacent in the surface interactions `si`.
        """
        import drjit as dr
        import mitsuba as mi

        return i * self.rays + dr.arange(mi.UInt32, dr.width(si)) % self.rays

    def draw_direction(
        self,
        index: JitInt,
        bsdf: MitsubaObject,
        si: MitsubaObject,
        types: int,
        constant: JitColour,
        active: JitMask = True,
    ) -> tuple[JitVector, JitFloat, JitColour]:
        """Draw the direction `index` by a BSDF; return it, its lobe's concentration κ, its weight.

        The direction is in the local frame of `si`. Its weight is (f - c) cosθ / p, where p is its
        density, c is the `constant`, and f are the components `types` of the BSDF.
        """
        import drjit as dr
        import mitsuba as mi

        context, u = mi.BSDFContext(), self.points.at(index, mi.Point3f)
        context.type_mask = types
        drawn, weight = bsdf.sample(context, si, u.x, mi.Point2f(u.y, u.z), active)
        # Where the BSDF draws no direction, the view's direction takes its place, with weight 0
        valid = active & (drawn.pdf > 0)
        wo, pdf = dr.select(valid, drawn.wo, si.wi), dr.select(valid, drawn.pdf, 1)
        # A lobe gets the width of the gap to the next direction; the lobe of a mirror has no width
        mirror = valid & mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Delta)
        kappa = dr.select(mirror, dr.inf, OVERLAP * 2 * dr.pi * self.count * pdf)
        cos = dr.maximum(wo.z * dr.sign(si.wi.z), 0)
        weight = mi.unpolarized_spectrum(weight) - constant * dr.select(mirror, 0, cos / pdf)
        return wo, kappa, mi.UnpolarizedSpectrum(dr.select(valid, weight, 0))


def split_off_constant(
    bsdf: MitsubaObject, si: MitsubaObject, active: JitMask, separate: bool
) -> tuple[JitColour, int, JitColour]:
    """Split BSDFs at `si` into a constant part and a remainder, which directions have to sample.

    Returns (c, types, constant). The constant part is c; the remainder is the sum of the BSDF's
    components `types`, Mitsuba's flags, minus `constant`. If `separate`, the diffuse components can
    be evaluated alone: c is their value, the remainder consists of the others, and `constant` is 0.
    Otherwise c is the smallest of a few values of the whole BSDF, and `constant` equals c.
    """
    import drjit as dr
    import mitsuba as mi

    matte, others = split_component_types(mi)
    if separate:
        return _eval_bsdf_components(bsdf, si, mi.Vector3f(0, 0, 1), active, matte), others, 0
    c = mi.UnpolarizedSpectrum(np.inf)
    for wo in SPREAD_DIRECTIONS.tolist():
        c = dr.minimum(
            c, _eval_bsdf_components(bsdf, si, mi.Vector3f(wo), active, matte | others) / wo[2]
        )
    return c, matte | others, c


def _eval_bsdf_components(
    bsdf: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask, types: int
) -> JitColour:
    """Evaluate BSDF × cosine of the components `types`, for `wo` on the same side as `si.wi`."""
    import drjit as dr
    import mitsuba as mi

    context = mi.BSDFContext()
    context.type_mask = types
    wo = mi.Vector3f(wo.x, wo.y, wo.z * dr.sign(si.wi.z))
    return mi.unpolarized_spectrum(bsdf.eval(context, si, wo, active))


def spread_cube_points(count: int) -> FloatArray:
    """Return `count` evenly spread points (count, 3) of the unit cube, for quasi-Monte Carlo.

    The first and last coordinates advance by powers of the plastic number [Roberts 2018].

    >>> spread_cube_points(2).shape
    (2, 3)
    """
    i = np.arange(count) + 0.5
    return np.stack([i / PLASTIC**2, i / count, i / PLASTIC], axis=1) % 1
