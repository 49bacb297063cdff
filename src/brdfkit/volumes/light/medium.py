"""`Medium`: the participating medium in the box of a volume, and its effect on light along rays.

`tracking.py` draws collisions without derivatives; their light gets derivatives here. A collision
at the distance t has the density σ(t) T(t), with the extinction σ, the optical depth τ up to t, and
the transmittance T = exp(-τ). The mean of the light f from there is thus the integral of f σ T over
t. Each sample gets the derivative of this integrand, divided by the density:

    ∂(f σ T) / (σ T) = ∂f + f (∂σ(t)/σ(t) - ∂τ)

The derivative of T is -T ∂τ. Both need ∂τ = ∫ ∂σ ds from 0 to t, which is the mean of t ∂σ(ut) for
u uniform in [0, 1): one more look-up of σ, at a random u, gives an unbiased estimate. Where σ = 0
nothing collides, so that the derivative of the light with respect to σ is only that of T.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.gradients import replace_grad
from brdfkit.mitsuba_bridge.channels import make_rgb_emission, make_rgb_spectrum, make_white_light
from brdfkit.volumes.light.constant_medium import is_constant, split_light
from brdfkit.volumes.light.majorants import Majorants, compute_majorants
from brdfkit.volumes.light.tracking import (
    estimate_passed_and_collided_light,
    estimate_transmittance,
)
from brdfkit.volumes.rays.box import intersect_box

TESTED_POINTS = 1 << 14  # number of random points at which extinction and majorants are compared
# Largest number of collisions along the box's diagonal; more take very long, with steps that single
# precision cannot represent
COLLISION_LIMIT = 1e6


@dataclass(init=False, eq=False)
class Medium:
    """A participating medium whose extinction, albedo and emission are Mitsuba volumes.

    - `extinction`: the extinction σ, whose box bounds the medium; if it is the plugin
      `transfer_function`, it also has RGB, an additional albedo or emission
    - `scale`: a `mi.Float` that multiplies σ
    - `albedo`: the share of collisions that scatter light; an albedo from RGB multiplies it
    - `emission`: the radiance that the medium adds per unit of length
    - `majorants`: upper bounds of σ; None before `recompute_majorants` is called
    - `is_constant`: whether σ is the same everywhere in the box, so that no tracking is needed
    """

    extinction: Any
    scale: Any
    albedo: Any
    emission: Any
    majorants: Any
    is_constant: bool

    def __init__(
        self,
        extinction: MitsubaObject,
        scale: JitFloat,
        albedo: MitsubaObject,
        emission: MitsubaObject,
    ) -> None:
        self.extinction, self.scale = extinction, scale
        self.albedo, self.emission, self.majorants = albedo, emission, None
        self.is_constant = is_constant(extinction)
        # What RGB means if σ is a transfer function: "albedo" or "emission"
        function = getattr(extinction, "function", None)
        self.colour = None if function is None else function.colour
        self.reflectance, self.light, self.white = (
            make_rgb_spectrum(),
            make_rgb_emission(),
            make_white_light(),
        )

    def recompute_majorants(self, local: bool) -> None:
        """Compute the majorants of the current extinction, in coarse cells if `local`.

        Raises `BrdfkitError` if they do not bound the extinction, or if it is far too large.
        """
        with dr.suspend_grad():
            self.majorants = compute_majorants(self.extinction, self.scale, local)
            self.majorants.require_extinction_below(self.evaluate_extinction, TESTED_POINTS)
        require_reasonable_extinction(self.majorants)

    def evaluate_extinction(self, p: JitVector, active: JitMask = True) -> JitFloat:
        """Return the extinction σ [1/unit of length] at points `p`."""
        import mitsuba as mi

        it = dr.zeros(mi.Interaction3f)
        it.p = p
        return self.scale * self.extinction.eval_1(it, active)

    def evaluate_coefficients(
        self, it: MitsubaObject, active: JitMask
    ) -> tuple[JitFloat, JitColour, JitColour]:
        """Return the extinction σ, the albedo and the emitted light at the points `it`.

        The light is that of a transfer function, as radiance per unit of length, divided by σ; 0
        if there is none.
        """
        import mitsuba as mi

        albedo, light = mi.unpolarized_spectrum(self.albedo.eval(it, active)), 0
        if self.colour is None:
            return self.evaluate_extinction(it.p, active), albedo, light
        sigma, rgb = self.extinction.eval_extinction_and_colour(it, active)
        if self.colour == "albedo":
            albedo = albedo * self.reflectance(rgb, it)
        else:
            light = self.light(rgb, it)
        return self.scale * sigma, albedo, light

    def estimate_passed_and_collided_light(
        self, ray: MitsubaObject, end: JitFloat, sampler: MitsubaObject, active: JitMask
    ) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Return the passing share of light, the colliding share, and a collision's distance.

        Both shares are random estimates up to the distance `end`. The first has the derivatives of
        the transmittance, and is NaN where σ exceeds its majorant.
        """
        near, far = self.clip_ray_to_box(ray, end)
        if self.is_constant:
            with dr.suspend_grad():
                sigma, length = self.measure_constant(ray, near, far, active)
                share, collided, t = split_light(sigma, length, sampler.next_1d(active))
            t = near + t
        else:
            share, collided, t, _ = estimate_passed_and_collided_light(
                self.evaluate_extinction, self.majorants, ray, near, far, sampler, active
            )
        depth = self.estimate_optical_depth(ray, end, sampler, active)
        return replace_grad(share, -share * depth), collided, t

    def estimate_transmittance(
        self, ray: MitsubaObject, end: JitFloat, sampler: MitsubaObject, active: JitMask
    ) -> JitFloat:
        """Return an unbiased random estimate of the transmittance from the ray's origin to `end`.

        It has the derivatives of the transmittance.
        """
        near, far = self.clip_ray_to_box(ray, end)
        if self.is_constant:
            sigma, length = self.measure_constant(ray, near, far, active)
            return dr.exp(-sigma * length)
        share, _ = estimate_transmittance(
            self.evaluate_extinction, self.majorants, ray, near, far, sampler, active
        )
        return replace_grad(share, -share * self.estimate_optical_depth(ray, end, sampler, active))

    def sample_emission(
        self,
        ray: MitsubaObject,
        end: JitFloat,
        sampler: MitsubaObject,
        active: JitMask,
        with_rgb: bool = False,
    ) -> JitColour:
        """Estimate the radiance that the medium emits along rays up to `end`, at a random distance.

        With `with_rgb` it includes the emission of a transfer function.
        """
        import mitsuba as mi

        near, far = self.clip_ray_to_box(ray, end)
        length = dr.maximum(far - near, 0)
        t = near + sampler.next_1d(active) * length
        it = dr.zeros(mi.Interaction3f)
        it.p, it.wavelengths = ray(t), ray.wavelengths
        e = mi.unpolarized_spectrum(self.emission.eval(it, active)) * self.white(it)
        if with_rgb:
            sigma, _, light = self.evaluate_coefficients(it, active)
            e += sigma * light
        return length * self.estimate_transmittance(ray, t, sampler, active) * e

    def estimate_optical_depth(
        self, ray: MitsubaObject, end: JitFloat, sampler: MitsubaObject, active: JitMask
    ) -> JitFloat:
        """Return an unbiased estimate of the optical depth up to the distance `end`.

        It is σ at one random point, times the length within the box.
        """
        near, far = self.clip_ray_to_box(ray, end)
        length = dr.maximum(far - near, 0)
        return length * self.evaluate_extinction(
            ray(near + sampler.next_1d(active) * length), active
        )

    def measure_constant(
        self, ray: MitsubaObject, near: JitFloat, far: JitFloat, active: JitMask
    ) -> tuple[JitFloat, JitFloat]:
        """Return the constant extinction, and the length of rays in the box; 0 if not `active`."""
        return self.evaluate_extinction(ray.o, active), dr.select(
            active, dr.maximum(far - near, 0), 0
        )

    def clip_ray_to_box(self, ray: MitsubaObject, end: JitFloat) -> tuple[JitFloat, JitFloat]:
        """Return the distances at which rays enter and leave the medium's box, at most `end`."""
        near, far = intersect_box(ray, self.extinction)
        return near, dr.minimum(far, end)


def require_reasonable_extinction(majorants: Majorants) -> None:
    """Raise `BrdfkitError` if rays would collide far too often, as with a wrong unit of length."""
    collisions = float(majorants.values.max()) * np.linalg.norm(majorants.cube_to_world[:3, :3])
    if collisions > COLLISION_LIMIT:
        raise BrdfkitError(
            f"The extinction reaches {majorants.values.max():.3g} per unit of length, and light "
            f"would collide {collisions:.2g} times across the volume, which takes forever; check "
            "the unit of length, or lower the extinction."
        )
