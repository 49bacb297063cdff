"""Emission and absorption: volumes that glow and dim what is behind them, but do not scatter light.

    L = T(0, d) L_behind + ∫ T(0, s) e(s) ds,   T(0, s) = exp(-∫ σ(t) dt) from 0 to s

over the part of a ray that lies within the box of `extinction` σ [1/unit] and before the first
surface. L_behind is the emission of that surface, or else of the environment. `emission` e
[radiance/unit] is not multiplied by σ; in spectral variants its colour is multiplied by D65, as an
emitter's.

An `extinction` of the type `transfer_function` adds its own emission, σ RGB. Where RGB is an
albedo, that is the light which the volume scatters in even light of radiance 1 that nothing dims.

The ray is cut into `steps` equal parts. In each, σ and e have the values of its midpoint, and the
integral is exact; the error of the whole is of second order in the length of a step. With `jitter`
they are the values at one random share of all parts, of each ray another: what undersampling shows
is noise then, and no rings. A ray ends where less than 1/10,000 of the light behind comes through.

[Max 1995]; [Lesar 2018, eq. 6.3]. Shows CT and MRI scans and smoke without a source of light; the
derivatives by both volumes are exact derivatives of the sum over the parts.
"""

import drjit as dr
import numpy as np

from brdfkit.host.channels import emission_of_rgb, white
from brdfkit.host.declared import count, declared, flag, volume
from brdfkit.host.reference_camera import through_unit_cube
from brdfkit.jit.recorded import recorded
from brdfkit.model.numerics import expm1
from brdfkit.volumes.along_ray import light_behind, within

OPAQUE = 1e-4  # transmittance

PARAMETERS = {
    "extinction": volume(1.0, "σ: absorbed per unit of length; its box bounds all", coloured=False),
    "emission": volume(0.0, "e: radiance that is added per unit of length"),
    "steps": count(128, (1, 1_000_000), "parts that a ray is cut into"),
    "jitter": flag(False, "whether the values are those at a random place in each part"),
}


def define(mi):
    """The class of `mi.SamplingIntegrator` for the current variant."""

    class EmissionAbsorption(declared(mi.SamplingIntegrator, PARAMETERS)):
        def __init__(self, props):
            super().__init__(props)
            self.has_colours = hasattr(self.extinction, "optics")
            self.white, self.light = white(), emission_of_rgb() if self.has_colours else None

        def optics(self, it, active):
            """σ and e at points."""
            e = mi.unpolarized_spectrum(self.emission.eval(it, active)) * self.white(it)
            if not self.has_colours:
                return self.extinction.eval_1(it, active), e
            sigma, rgb = self.extinction.optics(it, active)
            return sigma, e + sigma * self.light(rgb, it)

        @recorded
        def sample(self, scene, sampler, ray, medium=None, active=True):
            # The part of the ray within the volume, cut into steps
            end, behind = light_behind(scene, ray, active)
            near, far = within(ray, self.extinction)
            far = dr.minimum(far, end)
            inside = active & (far > near)
            step = dr.select(inside, (far - near) / self.steps, 0)
            place = sampler.next_1d(active) if self.jitter else mi.Float(0.5)

            def part(i, radiance, transmittance):
                it = mi.Interaction3f()
                it.p, it.wavelengths = ray(near + (mi.Float(i) + place) * step), ray.wavelengths
                sigma, e = self.optics(it, inside)
                depth = sigma * step
                radiance = radiance + transmittance * e * (mean_transmittance(depth) * step)
                return i + 1, radiance, transmittance * dr.exp(-depth)

            # Radiance and transmittance of all parts, from the nearest to the farthest
            _, radiance, transmittance = dr.while_loop(
                (mi.UInt32(0), mi.UnpolarizedSpectrum(0), mi.Float(1)),
                lambda i, radiance, transmittance: (
                    inside & (i < self.steps) & (transmittance > OPAQUE)
                ),
                part,
                max_iterations=self.steps,
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
