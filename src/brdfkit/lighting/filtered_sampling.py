"""Filtered importance sampling: a few directions of a BSDF, the same everywhere, and the mean
light about each.

A constant c is taken from the BSDF, for which the irradiance E is known; the directions see the
rest: L = π c E + Σ (f - c) cosθ / (N p) · mean light. A matte surface is exact; any c is right, so
that the lowest of a few values will do. [Colbert & Křivánek 2007]
"""

import numpy as np

from brdfkit.geometry.directions import from_angles
from brdfkit.host.arrays import Rows
from brdfkit.host.channels import emission_of_rgb
from brdfkit.lighting.scene_bsdfs import bsdfs_of, has_matte_part, is_one_of, matte_and_rest

# κ of the lobes over 2π / (solid angle of a direction). Sharper ones leave gaps, in which a lamp is
# lost, and wider ones blur: 64 directions of Ward's lobe under a probe with lamps (grace) come
# nearest to the truth with this
OVERLAP = 0.15
PLASTIC = 1.32471795724474602596  # x³ = x + 1, the golden ratio of two dimensions
SPREAD_OUT = from_angles(
    np.arccos(1 - (np.arange(8) + 0.5) / 8), 2 * np.pi / PLASTIC * np.arange(8)
)


class FilteredSampling:
    """Takes `count` directions of the BSDF at every pixel; its rays share them."""

    def __init__(self, count):
        self.count = count
        self.directions = None

    def radiance(self, scene, sampler, si, light, active):
        """The radiance towards `si.wi`, a spectrum of the current variant."""
        import drjit as dr
        import mitsuba as mi

        rays = sampler.sample_count()
        if self.directions is None or self.directions.rays != rays:
            self.directions = Directions(self.count, rays)
        matte, rest = matte_and_rest(mi)
        bsdfs = bsdfs_of(scene)
        apart = [bsdf for bsdf in bsdfs if has_matte_part(bsdf)]
        total = mi.UnpolarizedSpectrum(0)
        if apart:  # the directions are those of the other components
            here = active & is_one_of(si.bsdf(), apart)
            c = value(si, mi.Vector3f(0, 0, 1), here, matte)
            found = even(c, si, light) + self.uneven(si, light, here, rest)
            total = dr.select(here, found, total)
        if len(apart) < len(bsdfs):
            here = active & ~is_one_of(si.bsdf(), apart)
            c = mi.UnpolarizedSpectrum(np.inf)
            for wo in SPREAD_OUT.tolist():
                c = dr.minimum(c, value(si, mi.Vector3f(wo), here, matte | rest) / wo[2])
            found = even(c, si, light) + self.uneven(si, light, here, matte | rest, c)
            total = dr.select(here, dr.maximum(found, 0), total)
        return total

    def uneven(self, si, light, active, types, c=0):
        """The radiance by the components of some `types` less the constant `c`."""
        import drjit as dr
        import mitsuba as mi

        context, bsdf, spectrum = mi.BSDFContext(), si.bsdf(), emission_of_rgb()
        context.type_mask = types
        directions = self.directions
        ray = dr.arange(mi.UInt32, dr.width(si)) % directions.rays  # those of a pixel are adjacent

        def one(i, total):
            u = directions.at(i, ray)
            drawn, weight = bsdf.sample(context, si, u.x, mi.Point2f(u.y, u.z), active)
            valid, density = active & (drawn.pdf > 0), directions.count * drawn.pdf
            # A lobe as wide as the distance to the next direction; a mirror's has no width
            mirror = mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Delta)
            kappa = dr.select(mirror, dr.inf, OVERLAP * 2 * dr.pi * density)
            seen = spectrum(light.over_lobe(si.to_world(drawn.wo), kappa), si)
            weight = mi.unpolarized_spectrum(weight)
            cos = dr.maximum(drawn.wo.z * dr.sign(si.wi.z), 0)
            weight -= c * dr.select(mirror, 0, cos / drawn.pdf)
            return i + 1, total + dr.select(valid, weight * seen, 0)

        _, total = dr.while_loop(
            (mi.UInt32(0), mi.UnpolarizedSpectrum(0)),
            lambda i, total: active & (i < directions.per_ray),
            one,
        )
        return total / directions.per_ray


class Directions:
    """The numbers that draw at least `count` directions of a pixel, dealt out to its `rays`."""

    def __init__(self, count, rays):
        self.rays, self.per_ray = rays, -(-count // rays)
        self.count = rays * self.per_ray
        self.points = Rows(points(self.count))

    def at(self, i, ray):
        """The three numbers of direction `i` of a ray, a `mi.Point3f`."""
        import mitsuba as mi

        return self.points.at(i * self.rays + ray, mi.Point3f)


def even(c, si, light):
    """The radiance by a BSDF that is the constant `c`."""
    import drjit as dr
    import mitsuba as mi

    received = light.irradiance(si.to_world(mi.Vector3f(0, 0, dr.sign(si.wi.z))))
    return dr.pi * c * emission_of_rgb()(received, si)


def value(si, wo, active, types):
    """BSDF times cosine of the components of some `types`, towards `wo` on the side of `si.wi`."""
    import drjit as dr
    import mitsuba as mi

    context = mi.BSDFContext()
    context.type_mask = types
    wo = mi.Vector3f(wo.x, wo.y, wo.z * dr.sign(si.wi.z))
    return mi.unpolarized_spectrum(si.bsdf().eval(context, si, wo, active))


def points(count):
    """`count` points (count, 3) of the unit cube, evenly spread, the same always.

    Two coordinates advance by powers of the plastic number [Roberts 2018].

    >>> points(2).shape
    (2, 3)
    """
    i = np.arange(count) + 0.5
    return np.stack([i / PLASTIC**2, i / count, i / PLASTIC], axis=1) % 1
