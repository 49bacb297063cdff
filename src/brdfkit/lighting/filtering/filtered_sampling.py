"""Filtered importance sampling: a few directions of a BSDF, and the mean light about each.

All pixels take the same ones, so that there is no noise [Colbert & Křivánek 2007]. Where a BSDF is
the same all over its surface, its directions are stored for a grid of views.
"""

from brdfkit.core.array_types import JitColour, JitInt, JitMask, MitsubaObject
from brdfkit.lighting.filtering.bsdf_directions import Directions, split_constant
from brdfkit.lighting.filtering.filtered_light import Light
from brdfkit.lighting.filtering.scene_bsdfs import (
    CacheByValues,
    distinct_bsdfs,
    has_matte_part,
    is_one_of,
    is_same_everywhere,
)
from brdfkit.lighting.filtering.view_directions import ViewDirections
from brdfkit.mitsuba_bridge.channels import make_rgb_emission


class FilteredSampling:
    """Lights a pixel by `count` directions of its BSDF, which its rays share."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.directions: Directions | None = None

    def radiance(
        self,
        scene: MitsubaObject,
        sampler: MitsubaObject,
        si: MitsubaObject,
        light: Light,
        active: JitMask,
    ) -> JitColour:
        """Return the radiance towards `si.wi`, a spectrum of the current variant."""
        import drjit as dr
        import mitsuba as mi

        rays = sampler.sample_count()
        directions = self.directions
        if directions is None or directions.rays != rays:
            directions = self.directions = Directions(self.count, rays)
            self.views = CacheByValues(lambda bsdf: ViewDirections(bsdf, directions))
        total, bsdfs = mi.UnpolarizedSpectrum(0), distinct_bsdfs(scene)
        uniform = [bsdf for bsdf in bsdfs if is_same_everywhere(bsdf)]
        for bsdf, views in self.views.get(uniform):
            here = active & (si.bsdf() == mi.BSDFPtr(bsdf))
            total = dr.select(here, views.radiance(si, light, here), total)
        others = [bsdf for bsdf in bsdfs if bsdf not in uniform]
        for separate in (True, False):
            group = [bsdf for bsdf in others if has_matte_part(bsdf) == separate]
            if group:
                here = active & is_one_of(si.bsdf(), group)
                shown = self._draw_at_points(si, light, here, separate, directions)
                total = dr.select(here, shown, total)
        return total

    def _draw_at_points(
        self,
        si: MitsubaObject,
        light: Light,
        active: JitMask,
        separate: bool,
        directions: Directions,
    ) -> JitColour:
        """Return the radiance by directions that are drawn at the points `si` themselves.

        `separate`: see `split_constant`.
        """
        import drjit as dr
        import mitsuba as mi

        bsdf, spectrum = si.bsdf(), make_rgb_emission()
        c, types, constant = split_constant(bsdf, si, active, separate)

        def add_direction(i: JitInt, total: JitColour) -> tuple[JitInt, JitColour]:
            index = directions.index(i, si)
            wo, kappa, weight = directions.draw(index, bsdf, si, types, constant, active)
            mean = spectrum(light.mean_over_lobe(si.to_world(wo), kappa), si)
            return i + 1, total + weight * mean

        _, total = dr.while_loop(
            (mi.UInt32(0), mi.UnpolarizedSpectrum(0)),
            lambda i, total: active & (i < directions.per_ray),
            add_direction,
        )
        received = light.irradiance(si.to_world(mi.Vector3f(0, 0, dr.sign(si.wi.z))))
        total = total / directions.per_ray + dr.pi * c * spectrum(received, si)
        return dr.maximum(total, 0)
