"""Direct light from lights with one position or direction, with shadows by any method."""

from collections.abc import Callable, Iterable
from typing import Any

import drjit as dr

from brdfkit.core.array_types import (
    JitColour,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import restore_interrupt_handler
from brdfkit.core.projective.body import Empty
from brdfkit.mitsuba_bridge.properties.declarations import derive_plugin
from brdfkit.mitsuba_bridge.registration.registering import require_vectorised


def derive_shadow_integrator(mi: MitsubaModule, parameters: dict[str, Any]) -> Any:
    """Return the base class of integrators that find all shadows before each picture.

    A derived class adds the method `prepare_shadows(scene, sensor)`. It returns a function that
    makes the shadow of an emitter, for `reflect_direct_light`, or raises `Empty` if the emitter
    lights nothing that the camera sees.
    """

    Base: Any = derive_plugin(mi.SamplingIntegrator, parameters)

    class Shadowed(Base):
        lights: list[tuple[Any, Any]] = []  # noqa: RUF012  a new list for every picture

        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.name = props.plugin_name()

        def render(
            self,
            scene: MitsubaObject,
            sensor: Any = 0,
            seed: int = 0,
            spp: int = 0,
            develop: bool = True,
            evaluate: bool = True,
        ) -> Any:
            require_vectorised(self.name)
            sensor = scene.sensors()[sensor] if isinstance(sensor, int) else sensor
            make_shadow = self.prepare_shadows(scene, sensor)
            self.lights = [(e, _find_or_omit_shadow(make_shadow, e)) for e in scene.emitters()]
            try:
                return super().render(scene, sensor, seed, spp, develop, evaluate)
            finally:
                restore_interrupt_handler()

        def sample(
            self,
            scene: MitsubaObject,
            sampler: MitsubaObject,
            ray: MitsubaObject,
            medium: MitsubaObject = None,
            active: JitMask = True,
        ) -> tuple[JitColour, JitMask, list[Any]]:
            if [emitter for emitter, _ in self.lights] != scene.emitters():
                raise BrdfkitError(
                    f"{self.name} finds the shadows of a whole picture, and another integrator "
                    "asks it for single rays; render with it alone."
                )
            si = scene.ray_intersect(mi.Ray3f(ray), active)
            return (
                reflect_direct_light(si, sampler, self.lights, active),
                active & si.is_valid(),
                [],
            )

    return Shadowed


class NoShadow:
    """The shadow of a light that reaches nothing visible; its visibility does not matter."""

    def visibility(self, p: JitVector, n: JitVector, active: JitMask = True) -> JitFloat:
        return 1


def _find_or_omit_shadow(make_shadow: Callable[[Any], Any], emitter: MitsubaObject) -> Any:
    """Return the shadow of an emitter, or `NoShadow` if it is `Empty`."""
    try:
        return make_shadow(emitter)
    except Empty:
        return NoShadow()


def reflect_direct_light(
    si: MitsubaObject, sampler: MitsubaObject, lights: Iterable[tuple[Any, Any]], active: JitMask
) -> JitColour:
    """Return the light of emitters that surfaces at `si` reflect to the camera, with shadows.

    It is the sum of BRDF × cosine × irradiance × visibility over the `lights`, pairs of an emitter
    and its shadow. The shadow's `visibility(p, n, active)` is 0 to 1 at points `p` with normals n.
    """
    import mitsuba as mi

    valid = active & si.is_valid()
    bsdf, context = si.bsdf(), mi.BSDFContext()
    radiance: Any = mi.UnpolarizedSpectrum(0)
    for emitter, shadow in lights:
        ds, light = emitter.sample_direction(si, sampler.next_2d(valid), valid)
        value = bsdf.eval(context, si, si.to_local(ds.d), valid)
        lit = shadow.visibility(si.p, si.n, valid)
        radiance += mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light) * lit
    return mi.depolarizer(dr.select(valid, radiance, 0))
