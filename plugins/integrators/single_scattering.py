"""Single scattering: volumes in the light of a scene, path-traced without bias.

    L = T(0, d) L_behind + ∫ T(0, s) [e(s) + σ(s) α(s) ∫ p(ω, ω') L_in(s, ω') dω'] ds
    T(0, s) = exp(-∫ σ dt) from 0 to s

L is the radiance along a ray, T the transmittance. `extinction` σ, which is multiplied by `scale`,
`albedo` α and `emission` e [radiance/unit] are volumes. The medium fills the box of σ, which is
aligned with the world's axes unless σ is a `transfer_function`. The colour of a transfer function
is multiplied with the albedo, or, if it is an emission, σ times the colour is added to e. In
spectral variants e is multiplied by D65. `phase` p is any phase function. L_in is the light that
emitters send straight through the volume.

All emitters are supported: points, directions, surfaces, environments. Surfaces in front of, inside
or behind the volume show their emission and, by their BSDF, the light of the emitters that reaches
them through the volume. They cast shadows, even if their BSDF transmits light. The environment is
behind everything.

Ratio tracking along a ray finds both the transmitted share of light and a collision for the rest:
each sample includes the light from behind the volume and light that is scattered in it. The light
of emitters is sampled in two directions, which the power heuristic combines. The emitters draw one
of them: they draw two candidates, of which mostly the brighter one is followed. The phase function
or the BSDF draws the other direction. `majorants` are the bounds of σ that determine the steps:
`local` has one for each coarse cell, which is several times faster for scans with much empty space,
`global` has a single one. They are computed again when parameters change. An extinction above them
is an error; if an error goes unnoticed, the pixel is NaN.

`max_depth` counts as in Mitsuba's `volpath`: 1 for emitted light through the volume, 2 for single
scattering, more for multiple scattering. The means are equal to `volpath`, except for light that
`volpath` loses: 1.3e-4 σ of the light of thick media, and some light of spheres that are near.

With `background`, a radiance in linear sRGB, the camera sees this light behind the volume, and the
environment lights it all the same.

Derivatives flow to the volumes, the phase function, the BSDFs and the emitters' radiance, at any
`max_depth`, and are unbiased where σ is above 0. Where σ is 0, they do not include the light that a
larger σ would scatter, so a search for a volume should start above 0. They do not include changes
at the edges of surfaces either.

[Lesar 2018, chapter 6]; [Woodcock et al. 1965]; [Novák et al. 2014]; [Veach & Guibas 1995].
"""

import math
from collections.abc import Sequence
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import (
    FloatArray,
    JitColour,
    JitFloat,
    JitInt,
    JitMask,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.jit.gradients import replace_grad
from brdfkit.mitsuba_bridge.check_scenes import make_cube_camera
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_choice,
    declare_int,
    declare_number,
    declare_phase_function,
    declare_volume,
    derive_plugin,
)
from brdfkit.mitsuba_bridge.registration.registering import require_vectorised
from brdfkit.volumes.light import emitters
from brdfkit.volumes.light.medium import Medium
from brdfkit.volumes.light.path_sampling import apply_roulette, scatter_direct_light
from brdfkit.volumes.light.vertex import Vertex, make_medium_interaction
from brdfkit.volumes.rays.box import BACKGROUND

PARAMETERS = {
    "extinction": declare_volume(1.0, "σ: collisions per unit of length", coloured=False),
    "scale": declare_number(1.0, (0.0, math.inf), "what σ is multiplied by"),
    "albedo": declare_volume(1.0, "α: share of the collisions that scatter light"),
    "emission": declare_volume(0.0, "e: radiance that is added per unit of length"),
    "phase": declare_phase_function("p: the directions of scattered light, by default uniform"),
    "max_depth": declare_int(2, (1, 1_000_000), "largest number of segments of a path"),
    "majorants": declare_choice(
        ("local", "global"), "bounds of σ: of coarse cells, or one for all"
    ),
    "background": BACKGROUND,
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    Base: MitsubaObject = derive_plugin(mi.SamplingIntegrator, PARAMETERS)

    class SingleScattering(Base):
        def __init__(self, props: MitsubaObject) -> None:
            self.name, self.emits = props.plugin_name(), "emission" in props
            super().__init__(props)
            self.medium = Medium(self.extinction, self.scale, self.albedo, self.emission)
            self.parameters_changed()

        def parameters_changed(self, keys: Sequence[str] = ()) -> None:
            super().parameters_changed(keys)
            unchanged = keys and not {"extinction", "scale"} & set(keys)
            if not mi.variant().startswith("scalar") and not unchanged:
                self.medium.recompute_majorants(self.majorants == "local")

        def sample(
            self,
            scene: MitsubaObject,
            sampler: MitsubaObject,
            ray: MitsubaObject,
            medium: MitsubaObject = None,
            active: JitMask = True,
        ) -> tuple[JitColour, JitMask, list[JitFloat]]:
            require_vectorised(self.name)

            def continues(
                depth: JitInt, ray: MitsubaObject, throughput: JitColour, *_: Any
            ) -> JitMask:
                return active & (depth < self.max_depth) & dr.any(throughput != 0)

            def trace_segment(
                depth: JitInt,
                ray: MitsubaObject,
                throughput: JitColour,
                radiance: JitColour,
                density: JitFloat,
                sampler: MitsubaObject,
            ) -> tuple[Any, ...]:
                going = continues(depth, ray, throughput)
                light, vertex, weight = self.follow_segment(
                    scene, ray, density, depth == 1, sampler, going
                )
                radiance += throughput * light
                throughput *= weight
                radiance += throughput * scatter_direct_light(scene, self.medium, vertex, sampler)
                wo, weight, density = vertex.sample_direction(sampler)
                ray = dr.select(vertex.active, vertex.interaction.spawn_ray(wo), ray)
                throughput = apply_roulette(depth, throughput * weight, sampler)
                return depth + 1, ray, throughput, radiance, density, sampler

            one, zero = mi.UnpolarizedSpectrum(1), mi.UnpolarizedSpectrum(0)
            state = mi.UInt32(1), mi.Ray3f(ray), one, zero, mi.Float(0), sampler
            if self.max_depth > 1:
                state = dr.while_loop(
                    state, continues, trace_segment, max_iterations=self.max_depth - 1
                )
            depth, ray, throughput, radiance, density, _ = state
            going = active & dr.any(throughput != 0)
            radiance += throughput * self.add_last_segment(
                scene, ray, density, depth == 1, sampler, going
            )
            return mi.depolarizer(dr.select(active, radiance, 0)), active, []

        def follow_segment(
            self,
            scene: MitsubaObject,
            ray: MitsubaObject,
            density: JitFloat,
            is_first: JitMask,
            sampler: MitsubaObject,
            active: JitMask,
        ) -> tuple[JitColour, Vertex, JitColour]:
            """Follow one segment of each path, both to a collision in the medium and to its end.

            Returns the light that the segment adds, the `Vertex` where the path continues (at the
            collision, or at the surface at the end), and the factor of the path's throughput.
            """
            si = scene.ray_intersect(ray, active)
            share, collided, t = self.medium.estimate_passed_and_collided_light(
                ray, si.t, sampler, active
            )
            light = share * self.evaluate_end(scene, ray, si, density, is_first, active)

            # The path continues from the collision, or from the surface behind the medium
            passed = dr.select(si.is_valid(), dr.detach(share), 0)
            in_medium = active & (sampler.next_1d(active) * (collided + passed) < collided)
            mei = make_medium_interaction(ray, t)
            sigma, albedo, own = self.medium.evaluate_coefficients(mei, in_medium)
            # `one` is 1 with the derivatives of log σT (T: transmittance), or at surfaces of log T
            depth = self.medium.estimate_optical_depth(
                ray, dr.select(in_medium, t, si.t), sampler, active
            )
            log_sigma = dr.log(dr.select(in_medium, sigma, 1))
            one = replace_grad(mi.Float(1), log_sigma - depth)
            weight = (collided + passed) * one
            light += dr.select(in_medium, weight * own, 0)
            if self.emits:
                light += self.medium.sample_emission(ray, si.t, sampler, active)
            on_surface = active & ~in_medium & si.is_valid()
            vertex = Vertex(self.phase, mei, in_medium, si, on_surface)
            return light, vertex, weight * dr.select(in_medium, albedo, 1)

        def evaluate_end(
            self,
            scene: MitsubaObject,
            ray: MitsubaObject,
            si: MitsubaObject,
            density: JitFloat,
            is_first: JitMask,
            active: JitMask,
        ) -> JitColour:
            """Return the light from the end `si` of segments, weighted as a sampled direction.

            At the end of first segments, from the camera, the background is in front of the
            environment, which lights the medium all the same.
            """
            light = emitters.evaluate_emitter_hit(scene, ray, si, density, active)
            if self.background is None:
                return light
            behind = self.medium.light(self.background, si)
            return dr.select(active & is_first & ~si.is_valid(), behind, light)

        def add_last_segment(
            self,
            scene: MitsubaObject,
            ray: MitsubaObject,
            density: JitFloat,
            is_first: JitMask,
            sampler: MitsubaObject,
            active: JitMask,
        ) -> JitColour:
            """Return the light that the last segment of a path adds, without scattering."""
            si = scene.ray_intersect(ray, active)
            comes = emitters.is_emitter_hit(scene, si)
            if self.background is not None:
                comes |= is_first & ~si.is_valid()
            comes &= active
            light = self.evaluate_end(scene, ray, si, density, is_first, comes)
            light *= self.medium.estimate_transmittance(ray, si.t, sampler, comes)
            own = self.medium.colour == "emission"
            if self.emits or own:
                light += self.medium.sample_emission(ray, si.t, sampler, active, own)
            return light

    return SingleScattering


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene, and the radiance (3,) that every pixel of its picture should have.

    The camera looks at a homogeneous cube, with the sun behind the camera.
    """
    sigma, albedo, g, irradiance = 2.0, 0.5, -0.3, np.array([0.9, 0.6, 0.3])
    colour = {"type": "rgb", "value": irradiance.tolist()}
    scene = {
        "type": "scene",
        "integrator": {
            "type": "single_scattering",
            "extinction": sigma,
            "albedo": albedo,
            "phase": {"type": "hg", "g": g},
        },
        "sensor": make_cube_camera(),
        "sun": {"type": "directional", "direction": [0, 0, -1], "irradiance": colour},
    }
    # Henyey-Greenstein's phase function for light that is scattered straight back
    back = (1 - g**2) / (4 * math.pi * (1 + g**2 + 2 * g) ** 1.5)
    return scene, irradiance * albedo * back * (1 - math.exp(-2 * sigma)) / 2
