"""Direct light of lights that have one place or direction, with shadows however they are found."""

import drjit as dr

from brdfkit.host.declared import declared
from brdfkit.host.variants import refuse_scalar


def shadowed(mi, parameters):
    """The base class of integrators of direct light that find all shadows before each picture.

    A class derived from it has `shadows(scene, sensor)`: of each emitter of the scene in turn what
    `direct_light` takes.
    """

    class Shadowed(declared(mi.SamplingIntegrator, parameters)):
        def __init__(self, props):
            super().__init__(props)
            self.name = props.plugin_name()

        def render(self, scene, sensor=0, seed=0, spp=0, develop=True, evaluate=True):
            refuse_scalar(self.name)
            sensor = scene.sensors()[sensor] if isinstance(sensor, int) else sensor
            self.lights = list(zip(scene.emitters(), self.shadows(scene, sensor), strict=True))
            return super().render(scene, sensor, seed, spp, develop, evaluate)

        def sample(self, scene, sampler, ray, medium=None, active=True):
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            return direct_light(si, sampler, self.lights, active), active, []

    return Shadowed


def direct_light(si, sampler, lights, active):
    """The light that surfaces send to the camera: Σ ρ(ω_l, ω_o) cosθ_l E_l V.

    si : a `mi.SurfaceInteraction3f`.
    lights : pairs of an emitter and its shadow, whose `lit(p, n, active)` is V, in [0, 1], at
        points of surfaces and by their normals.
    """
    import mitsuba as mi

    seen = active & si.is_valid()
    bsdf, context = si.bsdf(), mi.BSDFContext()
    radiance = mi.UnpolarizedSpectrum(0)
    for emitter, shadow in lights:
        ds, light = emitter.sample_direction(si, sampler.next_2d(seen), seen)
        value = bsdf.eval(context, si, si.to_local(ds.d), seen)
        lit = shadow.lit(si.p, si.n, seen)
        radiance += mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light) * lit
    return mi.depolarizer(dr.select(seen, radiance, 0))
