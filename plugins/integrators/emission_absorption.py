"""Emission and absorption: volumes that emit light and absorb it, but do not scatter it.

    L = T(0, d) L_behind + ∫ T(0, s) e(s) ds,   T(0, s) = exp(-∫ σ(t) dt) from 0 to s

L is the radiance along a ray, T the transmittance. The integral is over the part of the ray that
lies within the box of `extinction` σ [1/unit] and in front of the first surface. L_behind is the
emission of this surface, or if there is none, `background` or else the environment. `emission` e
[radiance/unit] is not multiplied by σ; in spectral variants its colour is multiplied by D65, like
an emitter's.

An `extinction` of the type `transfer_function` adds its own emission, σ RGB. If RGB is an albedo,
this is the light that the volume scatters under even light of radiance 1 that reaches every point.

The ray is cut into `steps` equal parts. In each part σ and e have the values of its middle, and the
integral is exact; the error of the sum is of second order in the length of a step. With `jitter`
the first part has a random length, different for each ray, so undersampling shows noise instead of
rings. A ray ends where less than 1/10,000 of the light behind it comes through.

A transfer function may have peaks or jumps so thin that values pass them between two middles. If it
has such peaks when the scene is loaded, σ and σ RGB are the means of the function between the
values at both ends of a part [Engel et al. 2001]; steps as long as voxels are enough then. This
does not apply to functions of gradient magnitudes or of labels.

[Max 1995]; [Lesar 2018, eq. 6.3]. It renders CT scans, MRI scans and smoke without a source of
light. The derivatives with respect to both volumes are exact derivatives of the sum over the parts.
"""

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
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.jit.loops import record_loops
from brdfkit.mitsuba_bridge.channels import make_rgb_emission, make_white_light
from brdfkit.mitsuba_bridge.check_scenes import make_cube_camera
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_bool,
    declare_int,
    declare_volume,
    derive_plugin,
)
from brdfkit.model.numerics import expm1
from brdfkit.volumes.rays.box import BACKGROUND, evaluate_light_behind, intersect_box

OPAQUE_TRANSMITTANCE = 1e-4

PARAMETERS = {
    "extinction": declare_volume(1.0, "σ: absorbed share per unit, within its box", coloured=False),
    "emission": declare_volume(0.0, "e: radiance that is added per unit of length"),
    "steps": declare_int(128, (1, 1_000_000), "parts that a ray is cut into"),
    "jitter": declare_bool(False, "whether the parts are shifted by a random share of one"),
    "background": BACKGROUND,
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.SamplingIntegrator`."""
    Base: MitsubaObject = derive_plugin(mi.SamplingIntegrator, PARAMETERS)

    class EmissionAbsorption(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.has_colours = hasattr(self.extinction, "eval_extinction_and_colour")
            self.uses_means = self.has_colours and self.extinction.misses_peaks(self.steps)
            self.white = make_white_light()
            self.light = make_rgb_emission()

        def eval_integrals_at_end(self, it: MitsubaObject, active: JitMask) -> JitVector:
            """Return the transfer function's integrals at a part's end, () without `uses_means`."""
            return self.extinction.eval_integrals(it, active) if self.uses_means else ()

        def eval_extinction_and_emission(
            self, front: JitVector, it: MitsubaObject, back: JitVector, active: JitMask
        ) -> tuple[JitFloat, JitColour]:
            """Return the mean extinction σ and emission e of a part of a ray.

            `front` and `back` are the transfer function's integrals at both ends of the part, `it`
            is its middle.
            """
            e = mi.unpolarized_spectrum(self.emission.eval(it, active)) * self.white(it)
            if not self.has_colours:
                return self.extinction.eval_1(it, active), e
            if self.uses_means:
                sigma, glow = self.extinction.average_extinction_and_colour(front, back)
            else:
                sigma, rgb = self.extinction.eval_extinction_and_colour(it, active)
                glow = sigma * rgb
            return sigma, e + self.light(glow, it)

        @record_loops
        def sample(
            self,
            scene: MitsubaObject,
            sampler: MitsubaObject,
            ray: MitsubaObject,
            medium: MitsubaObject = None,
            active: JitMask = True,
        ) -> tuple[JitColour, JitMask, list[JitFloat]]:
            # The part of the ray within the volume is cut into steps
            end, behind = evaluate_light_behind(scene, ray, active, self.background, self.light)
            near, far = intersect_box(ray, self.extinction)
            far = dr.minimum(far, end)
            inside = active & (far > near)
            step = dr.select(inside, (far - near) / self.steps, 0)
            first = sampler.next_1d(active) if self.jitter else mi.Float(1)
            parts = self.steps + self.jitter

            def make_point(t: JitFloat) -> MitsubaObject:
                it = mi.Interaction3f()
                it.p, it.wavelengths = ray(t), ray.wavelengths
                return it

            def add_part(
                i: JitInt,
                radiance: JitColour,
                transmittance: JitFloat,
                start: JitFloat,
                front: JitVector,
            ) -> tuple[JitFloat, ...]:
                stop = dr.minimum(near + (mi.Float(i) + first) * step, far)
                back = self.eval_integrals_at_end(make_point(stop), inside)
                sigma, e = self.eval_extinction_and_emission(
                    front, make_point((start + stop) / 2), back, inside
                )
                length = stop - start
                depth = sigma * length
                radiance = radiance + transmittance * e * (mean_transmittance(depth) * length)
                return i + 1, radiance, transmittance * dr.exp(-depth), stop, back

            # Add up the radiance of all parts, from the nearest to the farthest
            start = mi.Float(near), self.eval_integrals_at_end(make_point(near), inside)
            _, radiance, transmittance, *_ = dr.while_loop(
                (mi.UInt32(0), mi.UnpolarizedSpectrum(0), mi.Float(1), *start),
                lambda i, radiance, transmittance, *_: (
                    inside & (i < parts) & (transmittance > OPAQUE_TRANSMITTANCE)
                ),
                add_part,
                max_iterations=parts,
            )
            radiance = dr.select(active, radiance + transmittance * behind, 0)
            return mi.depolarizer(radiance), active, []

    return EmissionAbsorption


def mean_transmittance(depth: JitFloat) -> JitFloat:
    """Return the mean transmittance (1 - exp(-depth)) / depth up to this optical `depth`."""
    return dr.select(depth > 0, -expm1(-depth) / dr.select(depth > 0, depth, 1), 1)


def reference() -> tuple[dict[str, Any], Sequence[float] | FloatArray]:
    """Return a test scene, and the radiance (3,) that every pixel of its picture should have.

    All rays cross one unit of a homogeneous volume, so that the radiance is
    e (1 - exp(-σ)) / σ + exp(-σ) L_behind.
    """
    sigma, e, behind = 2.0, np.array([0.9, 0.5, 0.1]), 0.3
    scene = {
        "type": "scene",
        "integrator": {
            "type": "emission_absorption",
            "extinction": sigma,
            "emission": {"type": "constvolume", "value": {"type": "rgb", "value": e.tolist()}},
            "steps": 16,
        },
        "sensor": make_cube_camera(),
        "behind": {"type": "constant", "radiance": {"type": "rgb", "value": behind}},
    }
    return scene, e * (1 - np.exp(-sigma)) / sigma + np.exp(-sigma) * behind
