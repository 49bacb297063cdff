"""Filtered importance sampling: a few directions of a BSDF, the same everywhere, and the mean
light about each [Colbert & Křivánek 2007].

Where a BSDF is the same all over its surface, its directions are kept for a grid of views.
"""

from brdfkit.lighting.filtering.drawn_directions import Directions, constant_and_rest
from brdfkit.lighting.filtering.drawn_views import DrawnViews
from brdfkit.lighting.filtering.scene_bsdfs import (
    KeptByValues,
    bsdfs_of,
    has_matte_part,
    is_one_of,
    is_same_everywhere,
)
from brdfkit.mitsuba_bridge.channels import emission_of_rgb


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
            self.views = KeptByValues(lambda bsdf: DrawnViews(bsdf, self.directions))
        total, bsdfs = mi.UnpolarizedSpectrum(0), bsdfs_of(scene)
        kept = [bsdf for bsdf in bsdfs if is_same_everywhere(bsdf)]
        for bsdf, views in self.views.of(kept):
            here = active & (si.bsdf() == mi.BSDFPtr(bsdf))
            total = dr.select(here, views.radiance(si, light, here), total)
        others = [bsdf for bsdf in bsdfs if bsdf not in kept]
        for apart in (True, False):
            group = [bsdf for bsdf in others if has_matte_part(bsdf) == apart]
            if group:
                here = active & is_one_of(si.bsdf(), group)
                total = dr.select(here, self.drawn_here(si, light, here, apart), total)
        return total

    def drawn_here(self, si, light, active, apart):
        """The radiance of BSDFs by directions that are drawn at the points `si` themselves."""
        import drjit as dr
        import mitsuba as mi

        bsdf, directions, spectrum = si.bsdf(), self.directions, emission_of_rgb()
        c, *rest = constant_and_rest(bsdf, si, active, apart)

        def one(i, total):
            place = directions.place(i, si)
            wo, kappa, weight = directions.draw(place, bsdf, si, *rest, active)
            seen = spectrum(light.over_lobe(si.to_world(wo), kappa), si)
            return i + 1, total + weight * seen

        _, total = dr.while_loop(
            (mi.UInt32(0), mi.UnpolarizedSpectrum(0)),
            lambda i, total: active & (i < directions.per_ray),
            one,
        )
        received = light.irradiance(si.to_world(mi.Vector3f(0, 0, dr.sign(si.wi.z))))
        total = total / directions.per_ray + dr.pi * c * spectrum(received, si)
        return dr.maximum(total, 0)
