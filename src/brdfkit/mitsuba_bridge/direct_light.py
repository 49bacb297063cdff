"""Direct light of lights that have one place or direction, with shadows however they are found."""

import drjit as dr

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import give_back_interrupts
from brdfkit.core.projective.body import Empty
from brdfkit.mitsuba_bridge.properties.declarations import derive_plugin
from brdfkit.mitsuba_bridge.registration.registering import require_vectorised


def derive_shadow_integrator(mi, parameters):
    """The base class of integrators of direct light that find all shadows before each picture.

    A class derived from it has `shadow_of(scene, sensor)`: a function from an emitter of the scene
    to what `direct_light` takes, which raises `Empty` where the light reaches nothing that is seen.
    """

    class Shadowed(derive_plugin(mi.SamplingIntegrator, parameters)):
        lights = ()

        def __init__(self, props):
            super().__init__(props)
            self.name = props.plugin_name()

        def render(self, scene, sensor=0, seed=0, spp=0, develop=True, evaluate=True):
            require_vectorised(self.name)
            sensor = scene.sensors()[sensor] if isinstance(sensor, int) else sensor
            shadow_of = self.shadow_of(scene, sensor)
            self.lights = [(each, find_shadow(shadow_of, each)) for each in scene.emitters()]
            try:
                return super().render(scene, sensor, seed, spp, develop, evaluate)
            finally:
                give_back_interrupts()

        def sample(self, scene, sampler, ray, medium=None, active=True):
            if [emitter for emitter, _ in self.lights] != scene.emitters():
                raise BrdfkitError(
                    f"{self.name} finds the shadows of a whole picture, and another integrator "
                    "asks it for single rays; render with it alone."
                )
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            return direct_light(si, sampler, self.lights, active), active & si.is_valid(), []

    return Shadowed


class NoShadow:
    """Of a light that reaches nothing that is seen, to which any shadow is right."""

    def lit_share(self, p, n, active=True):
        return 1


def find_shadow(shadow_of, emitter):
    """The shadow of an emitter, `NoShadow` where that is `Empty`."""
    try:
        return shadow_of(emitter)
    except Empty:
        return NoShadow()


def direct_light(si, sampler, lights, active):
    """The light that surfaces send to the camera: Σ ρ(ω_l, ω_o) cosθ_l E_l V.

    si : a `mi.SurfaceInteraction3f`.
    lights : pairs of an emitter and its shadow, whose `lit_share(p, n, active)` is V, in [0, 1], at
        points of surfaces and by their normals.
    """
    import mitsuba as mi

    seen = active & si.is_valid()
    bsdf, context = si.bsdf(), mi.BSDFContext()
    radiance = mi.UnpolarizedSpectrum(0)
    for emitter, shadow in lights:
        ds, light = emitter.sample_direction(si, sampler.next_2d(seen), seen)
        value = bsdf.eval(context, si, si.to_local(ds.d), seen)
        lit = shadow.lit_share(si.p, si.n, seen)
        radiance += mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light) * lit
    return mi.depolarizer(dr.select(seen, radiance, 0))
