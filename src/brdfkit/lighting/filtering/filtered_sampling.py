"""Filtered importance sampling: a few directions drawn by a BSDF, with mean light about each.

All pixels use the same random numbers, so that pictures have no noise [Colbert & Křivánek 2007]. If
a BSDF is uniform over its surface, its directions are stored for a grid of views.
"""

from math import inf

from brdfkit.core.array_types import JitColour, JitInt, JitMask, MitsubaObject
from brdfkit.lighting.filtering.bsdf_directions import OVERLAP, Directions, split_off_constant
from brdfkit.lighting.filtering.filtered_light import Light
from brdfkit.lighting.filtering.scene_bsdfs import (
    CacheByValues,
    has_separate_diffuse_part,
    is_uniform_over_surface,
    list_distinct_bsdfs,
    points_to_one_of,
)
from brdfkit.lighting.filtering.view_directions import ViewDirections
from brdfkit.mitsuba_bridge.channels import make_rgb_emission


class FilteredSampling:
    """Lights each pixel from `count` directions that its BSDF draws, shared out among its rays."""

    # The lobes of light overlap; shadow rays keep to the part that a direction represents
    shadow_sharpness = 1 / OVERLAP

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
        """Return the radiance that the surfaces at `si` reflect towards `si.wi`.

        It is a spectrum of the current variant. The `light` is filtered; `sampler` only gives the
        number of rays per pixel.
        """
        import drjit as dr
        import mitsuba as mi

        total, directions = mi.UnpolarizedSpectrum(0), self._find_directions(sampler)
        uniform, others = _sort_bsdfs(scene)
        for bsdf, views in self.views.get_or_make_results(uniform):
            here = active & (si.bsdf() == mi.BSDFPtr(bsdf))
            total = dr.select(here, views.radiance(si, light, here), total)
        for separate in (True, False):
            group = [bsdf for bsdf in others if has_separate_diffuse_part(bsdf) == separate]
            if group:
                here = active & points_to_one_of(si.bsdf(), group)
                shown = self._estimate_radiance_at_points(si, light, here, separate, directions)
                total = dr.select(here, shown, total)
        return total

    def find_sharpest_lobe(self, scene: MitsubaObject, sampler: MitsubaObject) -> float:
        """Return the largest concentration κ of the lobes of light, infinite where it is unknown.

        It is known where the BSDFs of all surfaces are stored for a grid of views.
        """
        self._find_directions(sampler)
        uniform, others = _sort_bsdfs(scene)
        if others:
            return inf
        stored = self.views.get_or_make_results(uniform)
        return max((views.find_sharpest_lobe() for _, views in stored), default=inf)

    def _find_directions(self, sampler: MitsubaObject) -> Directions:
        """Return the random numbers for the sampler's number of rays per pixel."""
        rays = sampler.sample_count()
        directions = self.directions
        if directions is None or directions.rays != rays:
            directions = self.directions = Directions(self.count, rays)
            self.views = CacheByValues(lambda bsdf: ViewDirections(bsdf, directions))
        return directions

    def _estimate_radiance_at_points(
        self,
        si: MitsubaObject,
        light: Light,
        active: JitMask,
        separate: bool,
        directions: Directions,
    ) -> JitColour:
        """Estimate the reflected radiance with directions drawn at the points `si`, not stored.

        `separate` says whether the BSDFs have diffuse components that can be evaluated alone.
        """
        import drjit as dr
        import mitsuba as mi

        bsdf, spectrum = si.bsdf(), make_rgb_emission()
        c, types, constant = split_off_constant(bsdf, si, active, separate)

        def add_direction(i: JitInt, total: JitColour) -> tuple[JitInt, JitColour]:
            index = directions.find_direction_index(i, si)
            wo, kappa, weight = directions.draw_direction(index, bsdf, si, types, constant, active)
            mean = spectrum(light.mean_radiance_over_lobe(si.to_world(wo), kappa), si)
            return i + 1, total + weight * mean

        _, total = dr.while_loop(
            (mi.UInt32(0), mi.UnpolarizedSpectrum(0)),
            lambda i, total: active & (i < directions.per_ray),
            add_direction,
        )
        received = light.irradiance(si.to_world(mi.Vector3f(0, 0, dr.sign(si.wi.z))))
        total = total / directions.per_ray + dr.pi * c * spectrum(received, si)
        return dr.maximum(total, 0)


def _sort_bsdfs(scene: MitsubaObject) -> tuple[list[MitsubaObject], list[MitsubaObject]]:
    """Return the BSDFs in a scene that are uniform over surfaces, and the others."""
    bsdfs = list_distinct_bsdfs(scene)
    uniform = [bsdf for bsdf in bsdfs if is_uniform_over_surface(bsdf)]
    return uniform, [bsdf for bsdf in bsdfs if bsdf not in uniform]
