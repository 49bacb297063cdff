"""The direct light that a field's surface reflects to a camera, from lamps and an environment.

A lamp's light is found in one of three ways, by the integrator's parameter `shading`:

split       f(ω_0) · L · (solid angle of the whole lamp) · (its visible share)
estimated   the mean of f(ω_s) L / p(ω_s) over visible samples s of the lamp; the edge that one
            march found decides which samples are visible
exact       the same, with a shadow ray to each sample

f is the BSDF times the cosine at the surface, ω_0 the direction of the lamp's centre, ω_s that of a
sample, p its probability density, L the radiance.

[Bálint et al. 2019, equations 5.1, 5.2]
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import drjit as dr

from brdfkit.core.array_types import JitColour, JitMask, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.loops import record_loops
from brdfkit.distance_fields.shading.lamps import Lamp
from brdfkit.distance_fields.shading.visible_point import VisiblePoint
from brdfkit.distance_fields.shadows import LightCone, Shadow, find_edge, make_light_cone
from brdfkit.distance_fields.shadows.soft_shadow import METHODS, WITH_EDGE, compute_shadow_by_name
from brdfkit.distance_fields.tracing.cone_tracing import cone_trace

SHADINGS = "split", "estimated", "exact"
SHADOWS = [*METHODS, "none"]


@dataclass(frozen=True)
class DirectLight:
    """The settings of the integrator `distance_field` for direct light, and its computation.

    `shadow`, `direction`, `epsilon`, `rays`: method of soft shadows and its settings, see
    `soft_shadow`.
    `shading`: how a lamp's light is computed, a name in `SHADINGS`.
    `samples`: number of samples per lamp or environment.
    `far`: distance at which rays end [unit of length].
    """

    shadow: str
    direction: str
    epsilon: float
    rays: int
    shading: str
    samples: int
    far: float

    def __post_init__(self) -> None:
        if self.shading == "estimated" and self.shadow not in WITH_EDGE:
            raise BrdfkitError(
                f"distance_field: shading = estimated needs a straight shadow edge, which "
                f"shadow = {self.shadow} does not find; give one of {', '.join(WITH_EDGE)}."
            )

    def compute_light_from_lamp(
        self, lamp: Lamp, seen: VisiblePoint, bsdf: MitsubaObject, sampler: MitsubaObject
    ) -> JitColour:
        """Return the radiance that a visible point reflects to the camera from a lamp."""
        import mitsuba as mi

        if self.shading == "split" or not lamp.has_shape:
            return self._compute_split_light(lamp, seen, bsdf)
        is_visible: Callable[[MitsubaObject], JitMask]
        if self.shading == "exact":
            is_visible = partial(self._is_unoccluded, seen)
        else:
            ds, _ = lamp.sample_centre(seen.si, seen.found)
            cone, shadow = self._compute_lamp_shadow(lamp, seen, ds)
            with dr.suspend_grad():
                edge = find_edge(seen.field, cone, shadow)

            def is_before_edge(ds: MitsubaObject) -> JitMask:
                return edge.is_point_visible(cone, ds.p)

            is_visible = is_before_edge

        si, emitter = seen.si, lamp.emitter

        def estimate_lamp_light(sampler: MitsubaObject) -> JitColour:
            ds, light = emitter.sample_direction(si, sampler.next_2d(seen.found), seen.found)
            value = bsdf.eval(mi.BSDFContext(), si, si.to_local(ds.d), seen.found)
            reflected = mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light)
            return dr.select(is_visible(ds), reflected, 0)

        return self._average_samples(estimate_lamp_light, sampler, seen.found)

    def _compute_split_light(
        self, lamp: Lamp, seen: VisiblePoint, bsdf: MitsubaObject
    ) -> JitColour:
        """Return the light reflected from a lamp's centre, times the lamp's visible share."""
        import mitsuba as mi

        ds, light = lamp.sample_centre(seen.si, seen.found)
        value = bsdf.eval(mi.BSDFContext(), seen.si, seen.si.to_local(ds.d), seen.found)
        reflected = mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light)
        if self.shadow == "none":
            return reflected
        return reflected * self._compute_lamp_shadow(lamp, seen, ds)[1].visible

    @record_loops
    def _compute_lamp_shadow(
        self, lamp: Lamp, seen: VisiblePoint, ds: MitsubaObject
    ) -> tuple[LightCone, Shadow]:
        """Return the cone from a visible point to a lamp, and the `Shadow` in it.

        Camera rays that met nothing start beside the lamp, where the march soon ends.

        ds : direction to the lamp's centre.
        """
        centre, radius = lamp.bounding_sphere(seen.si, ds, self.far)
        beside = centre + type(centre)(0, 0, 1) * (2 * radius + 1)
        start = dr.select(seen.found, seen.middle, beside)
        cone = make_light_cone(start, centre, radius, seen.ball)
        settings = self.epsilon, self.direction, self.rays
        return cone, compute_shadow_by_name(self.shadow, seen.field, cone, *settings)

    @record_loops
    def _is_unoccluded(self, seen: VisiblePoint, ds: MitsubaObject) -> JitMask:
        """Return whether the ray to an emitter's sample misses the field; True without shadows."""
        import mitsuba as mi

        if self.shadow == "none":
            return mi.Bool(True)
        f, lipschitz = seen.field.distance, seen.field.lipschitz
        settings = {"lipschitz": lipschitz, "precision": seen.ball / 2, "active": seen.found}
        far = dr.minimum(ds.dist, self.far)
        return ~cone_trace(f, seen.middle, ds.d, far, **settings).found

    def compute_light_from_environment(
        self, sky: MitsubaObject, seen: VisiblePoint, bsdf: MitsubaObject, sampler: MitsubaObject
    ) -> JitColour:
        """Return the radiance that a visible point reflects to the camera from an environment.

        As many samples of the BSDF as of the environment are combined by the balance heuristic.
        """
        import mitsuba as mi

        si, active, context = seen.si, seen.found, mi.BSDFContext()

        def estimate_environment_light(sampler: MitsubaObject) -> JitColour:
            ds, light = sky.sample_direction(si, sampler.next_2d(active), active)
            wo = si.to_local(ds.d)
            value = mi.unpolarized_spectrum(bsdf.eval(context, si, wo, active))
            share = ds.pdf / (ds.pdf + bsdf.pdf(context, si, wo, active))
            by_light = value * mi.unpolarized_spectrum(light) * dr.detach(share)
            total = dr.select(self._is_unoccluded(seen, ds), by_light, 0)

            with dr.suspend_grad():
                drawn, weight = bsdf.sample(
                    context, si, sampler.next_1d(active), sampler.next_2d(active), active
                )
                there = dr.zeros(mi.SurfaceInteraction3f, dr.width(si.p))
                there.wavelengths, there.wi = si.wavelengths, -si.to_world(drawn.wo)
                ds = dr.zeros(mi.DirectionSample3f, dr.width(si.p))
                ds.d = -there.wi
                ds.dist = dr.inf  # type: ignore[assignment]  # Mitsuba takes a number, too
                mirror = mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Delta)
                other = dr.select(mirror, 0, sky.pdf_direction(si, ds, active))
                visible = (drawn.pdf > 0) & self._is_unoccluded(seen, ds)
            value = mi.unpolarized_spectrum(bsdf.eval(context, si, drawn.wo, active))
            ratio = dr.select(mirror, mi.unpolarized_spectrum(weight), value / drawn.pdf)
            radiance = mi.unpolarized_spectrum(sky.eval(there, active))
            by_bsdf = ratio * radiance * drawn.pdf / (drawn.pdf + other)
            return total + dr.select(visible, by_bsdf, 0)

        return self._average_samples(estimate_environment_light, sampler, active)

    def _average_samples(
        self,
        estimate: Callable[[MitsubaObject], JitColour],
        sampler: MitsubaObject,
        active: JitMask,
    ) -> JitColour:
        """Return the mean of `estimate(sampler)` over all samples of an emitter."""
        import mitsuba as mi

        _, _, total = dr.while_loop(
            (mi.UInt32(0), sampler, mi.UnpolarizedSpectrum(0)),
            lambda i, sampler, total: active & (i < self.samples),
            lambda i, sampler, total: (i + 1, sampler, total + estimate(sampler)),
            max_iterations=self.samples,
        )
        return total / self.samples
