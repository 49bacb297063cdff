"""The light that lamps and an environment send to a camera by way of a field's surface.

split       f(ω_0) · L · (solid angle of the whole lamp) · (the share of it that is seen)
estimated   the mean of f(ω_s) L / p(ω_s) over samples s of the lamp that the edge of the shadow,
            found by one march, lets through
exact       the same, with a ray of its own for each sample

f is the BSDF times the cosine at the surface, ω_0 the direction of the lamp's middle, L the
radiance.

[Bálint et al. 2019, equations 5.1, 5.2]
"""

from dataclasses import dataclass

import drjit as dr

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.loops import recorded
from brdfkit.distance_fields.shadows import edge, light_cone
from brdfkit.distance_fields.shadows.by_name import METHODS, SOFT, by_name
from brdfkit.distance_fields.tracing.sphere_tracing import sphere_trace

SHADINGS = "split", "estimated", "exact"
SHADOWS = [*METHODS, "none"]


@dataclass(frozen=True)
class DirectLight:
    """How light is found: the settings of the integrator of the same names."""

    shadow: str
    direction: str
    epsilon: float
    rays: int
    shading: str
    samples: int
    far: float

    def __post_init__(self):
        if self.shading == "estimated" and self.shadow not in SOFT:
            raise BrdfkitError(
                f"distance_field: shading = estimated needs the edge that one march finds, and "
                f"shadow = {self.shadow} finds none; give one of {', '.join(SOFT)}."
            )

    def by_lamp(self, lamp, field, seen, bsdf, sampler, active):
        """The radiance of a `Lamp`'s light that a `SeenPoint` sends to the camera."""
        if self.shading == "split" or lamp.shape is None:
            return self.by_middle(lamp, field, seen, bsdf, active)
        if self.shading == "exact":
            return self.by_rays(lamp.emitter, field, seen, bsdf, sampler, active)
        cone, found = self.shadow_of(lamp, field, seen, lamp.middle_light(seen.si, active)[0])
        with dr.suspend_grad():
            line = edge(field, cone, found)

        def shows(ds):
            return line.shows(cone, ds.p)

        return self.by_samples(lamp.emitter, shows, seen.si, bsdf, sampler, active)

    def by_middle(self, lamp, field, seen, bsdf, active):
        import mitsuba as mi

        ds, light = lamp.middle_light(seen.si, active)
        value = bsdf.eval(mi.BSDFContext(), seen.si, seen.si.to_local(ds.d), active)
        visible = 1
        if self.shadow != "none":
            _, found = self.shadow_of(lamp, field, seen, ds)
            visible = found.visible
        return mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light) * visible

    @recorded
    def shadow_of(self, lamp, field, seen, ds):
        """The cone to a lamp, and the `Shadow` in it.

        Rays that saw nothing look at the lamp from beside it, where the march soon ends.
        """
        centre, radius = lamp.sphere(seen.si, ds, self.far)
        beside = centre + type(centre)(0, 0, 1) * (2 * radius + 1)
        cone = light_cone(dr.select(seen.found, seen.middle, beside), centre, radius, seen.ball)
        how = self.epsilon, self.direction, self.rays
        return cone, by_name(self.shadow, field, cone, *how)

    def by_rays(self, emitter, field, seen, bsdf, sampler, active):
        """The same for any emitter, with a ray to each sample."""

        def shows(ds):
            return self.is_free(field, seen, ds, active)

        return self.by_samples(emitter, shows, seen.si, bsdf, sampler, active)

    @recorded
    def is_free(self, field, seen, ds, active):
        """Whether the ray to a sample of an emitter misses the field, or no shadow is wanted."""
        import mitsuba as mi

        if self.shadow == "none":
            return mi.Bool(True)
        settings = {"lipschitz": field.lipschitz, "precision": seen.ball / 2, "active": active}
        far = dr.minimum(ds.dist, self.far)
        return ~sphere_trace(field.distance, seen.middle, ds.d, far, **settings).found

    def by_samples(self, emitter, shows, si, bsdf, sampler, active):
        """The mean over samples of an emitter of those for which `shows(ds)`."""
        import mitsuba as mi

        def one(sampler):
            ds, light = emitter.sample_direction(si, sampler.next_2d(active), active)
            value = bsdf.eval(mi.BSDFContext(), si, si.to_local(ds.d), active)
            found = mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light)
            return dr.select(shows(ds), found, 0)

        return self.mean(one, sampler, active)

    def by_sky(self, sky, field, seen, bsdf, sampler, active):
        """The same for an environment, and as many samples of the BSDF, weighted by balance."""
        import mitsuba as mi

        si, context = seen.si, mi.BSDFContext()

        def one(sampler):
            ds, light = sky.sample_direction(si, sampler.next_2d(active), active)
            wo = si.to_local(ds.d)
            value = mi.unpolarized_spectrum(bsdf.eval(context, si, wo, active))
            share = ds.pdf / (ds.pdf + bsdf.pdf(context, si, wo, active))
            by_light = value * mi.unpolarized_spectrum(light) * dr.detach(share)
            total = dr.select(self.is_free(field, seen, ds, active), by_light, 0)

            with dr.suspend_grad():
                drawn, weight = bsdf.sample(
                    context, si, sampler.next_1d(active), sampler.next_2d(active), active
                )
                there = dr.zeros(mi.SurfaceInteraction3f, dr.width(si.p))
                there.wavelengths, there.wi = si.wavelengths, -si.to_world(drawn.wo)
                ds = dr.zeros(mi.DirectionSample3f, dr.width(si.p))
                ds.d, ds.dist = -there.wi, dr.inf
                mirror = mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Delta)
                other = dr.select(mirror, 0, sky.pdf_direction(si, ds, active))
                found = (drawn.pdf > 0) & self.is_free(field, seen, ds, active)
            value = mi.unpolarized_spectrum(bsdf.eval(context, si, drawn.wo, active))
            ratio = dr.select(mirror, mi.unpolarized_spectrum(weight), value / drawn.pdf)
            radiance = mi.unpolarized_spectrum(sky.eval(there, active))
            by_bsdf = ratio * radiance * drawn.pdf / (drawn.pdf + other)
            return total + dr.select(found, by_bsdf, 0)

        return self.mean(one, sampler, active)

    def mean(self, one, sampler, active):
        """The mean of `one(sampler)` over all samples."""
        import mitsuba as mi

        _, _, total = dr.while_loop(
            (mi.UInt32(0), sampler, mi.UnpolarizedSpectrum(0)),
            lambda i, sampler, total: active & (i < self.samples),
            lambda i, sampler, total: (i + 1, sampler, total + one(sampler)),
            max_iterations=self.samples,
        )
        return total / self.samples
