"""Emission and absorption: volumes that glow and dim what is behind them, but do not scatter light.

    L = T(0, d) L_behind + ∫ T(0, s) e(s) ds,   T(0, s) = exp(-∫ σ(t) dt) from 0 to s

over the part of a ray that lies within the box of `extinction` σ [1/unit] and before the first
surface. L_behind is the emission of that surface, or else of the environment. `emission` e
[radiance/unit] is not multiplied by σ; in spectral variants its colour is multiplied by D65, as an
emitter's.

An `extinction` of the type `transfer_function` adds its own emission, σ RGB. Where RGB is an
albedo, that is the light which the volume scatters in even light of radiance 1 that nothing dims.

The ray is cut into `steps` equal parts. In each, σ and e have the values of its middle, and the
integral is exact; the error of the whole is of second order in the length of a step. With `jitter`
the first part is cut at a random share, of each ray another, and the last one is what is left: what
undersampling shows is noise then, and no rings. A ray ends where less than 1/10,000 of the light
behind comes through.

Peaks and jumps of a transfer function that are thinner than what values change in a step would be
missed between two middles. Where it has such as a scene is loaded, σ and σ RGB are the function's
means between the values at both ends of a part [Engel et al. 2001]: steps as long as voxels are
enough then. Not so of functions of gradient magnitudes, and of labels.

[Max 1995]; [Lesar 2018, eq. 6.3]. Shows CT and MRI scans and smoke without a source of light; the
derivatives by both volumes are exact derivatives of the sum over the parts.
"""

import drjit as dr
import numpy as np

from brdfkit.core.jit.loops import recorded
from brdfkit.mitsuba_bridge.channels import emission_of_rgb, white
from brdfkit.mitsuba_bridge.check_scenes import through_unit_cube
from brdfkit.mitsuba_bridge.properties.declarations import count, declared, flag, volume
from brdfkit.model.numerics import expm1
from brdfkit.volumes.rays.along_ray import light_behind, within

OPAQUE = 1e-4  # transmittance

PARAMETERS = {
    "extinction": volume(1.0, "σ: absorbed per unit of length; its box bounds all", coloured=False),
    "emission": volume(0.0, "e: radiance that is added per unit of length"),
    "steps": count(128, (1, 1_000_000), "parts that a ray is cut into"),
    "jitter": flag(False, "whether the first part is cut at a random place, and all follow it"),
}


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""

    class EmissionAbsorption(declared(mi.SamplingIntegrator, PARAMETERS)):
        def __init__(self, props):
            super().__init__(props)
            self.has_colours = hasattr(self.extinction, "optics")
            self.sees_between = self.has_colours and self.extinction.is_missed_by(self.steps)
            self.white, self.light = white(), emission_of_rgb() if self.has_colours else None

        def end(self, it, active):
            """What `optics` has to know of an end of a part."""
            return self.extinction.integrals(it, active) if self.sees_between else ()

        def optics(self, front, it, back, active):
            """σ and e of the part between two ends, with its middle `it`."""
            e = mi.unpolarized_spectrum(self.emission.eval(it, active)) * self.white(it)
            if not self.has_colours:
                return self.extinction.eval_1(it, active), e
            if self.sees_between:
                sigma, glow = self.extinction.mean_optics(front, back)
            else:
                sigma, rgb = self.extinction.optics(it, active)
                glow = sigma * rgb
            return sigma, e + self.light(glow, it)

        @recorded
        def sample(self, scene, sampler, ray, medium=None, active=True):
            # The part of the ray within the volume, cut into steps
            end, behind = light_behind(scene, ray, active)
            near, far = within(ray, self.extinction)
            far = dr.minimum(far, end)
            inside = active & (far > near)
            step = dr.select(inside, (far - near) / self.steps, 0)
            first = sampler.next_1d(active) if self.jitter else mi.Float(1)
            parts = self.steps + self.jitter

            def at(t):
                it = mi.Interaction3f()
                it.p, it.wavelengths = ray(t), ray.wavelengths
                return it

            def part(i, radiance, transmittance, start, front):
                stop = dr.minimum(near + (mi.Float(i) + first) * step, far)
                back = self.end(at(stop), inside)
                sigma, e = self.optics(front, at((start + stop) / 2), back, inside)
                length = stop - start
                depth = sigma * length
                radiance = radiance + transmittance * e * (mean_transmittance(depth) * length)
                return i + 1, radiance, transmittance * dr.exp(-depth), stop, back

            # Radiance and transmittance of all parts, from the nearest to the farthest
            start = mi.Float(near), self.end(at(near), inside)
            _, radiance, transmittance, *_ = dr.while_loop(
                (mi.UInt32(0), mi.UnpolarizedSpectrum(0), mi.Float(1), *start),
                lambda i, radiance, transmittance, *_: (
                    inside & (i < parts) & (transmittance > OPAQUE)
                ),
                part,
                max_iterations=parts,
            )
            radiance = dr.select(active, radiance + transmittance * behind, 0)
            return mi.depolarizer(radiance), active, []

    return EmissionAbsorption


def mean_transmittance(depth):
    """(1 - exp(-depth)) / depth, along a homogeneous medium of this optical `depth`."""
    return dr.select(depth > 0, -expm1(-depth) / dr.select(depth > 0, depth, 1), 1)


def reference():
    """A scene, and the radiance (3,) of each of its pixels: e (1 - exp(-σ)) / σ + exp(-σ) L.

    All rays cross one unit of a homogeneous volume.
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
        "sensor": through_unit_cube(),
        "behind": {"type": "constant", "radiance": {"type": "rgb", "value": behind}},
    }
    return scene, e * (1 - np.exp(-sigma)) / sigma + np.exp(-sigma) * behind
