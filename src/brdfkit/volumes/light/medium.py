"""`Medium`: the matter in the box of a volume, and its effect on light along rays.

`tracking.py` draws places without derivatives; light from these places has derivatives. Light f
from a collision at t, which has the density σ(t) T(t) with T = exp(-τ), has the derivative

    ∂(f σ T) / (σ T) = ∂f + f (∂σ(t)/σ(t) - ∂τ),   ∂τ = ∫ ∂σ ds from 0 to t = mean of t ∂σ(ut)

for u uniform in [0, 1), and the transmitted share T has the derivative -T ∂τ. One more look-up, at
one u, thus makes each unbiased, even where σ meets its majorant and null collisions have no
derivative. Nothing collides where σ = 0: there only ∂τ is found.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.channels import make_rgb_emission, make_rgb_spectrum, make_white_light
from brdfkit.volumes.light.majorants import Majorants, compute_majorants
from brdfkit.volumes.light.tracking import estimate_transmittance, split_light
from brdfkit.volumes.rays.box import intersect_box

replace_grad: Any = dr.replace_grad  # Dr.Jit's stub knows no result of it

TESTED_POINTS = 1 << 14  # at which an extinction is compared to its majorants
COLLISION_LIMIT = 1e6  # across a box: more take very long, and lose steps to single precision


@dataclass(init=False, eq=False)
class Medium:
    """The matter that Mitsuba volumes describe, for the current variant.

    `extinction` is σ, whose box bounds the medium; a `transfer_function` has RGB as well. `scale`
    is a factor of σ. `albedo` is α, the share of collisions that scatter light, times RGB where
    that is an albedo. `emission` is e, the radiance that is added per length. `majorants` are
    bounds of σ, which `update_majorants` computes.
    """

    extinction: Any
    scale: Any
    albedo: Any
    emission: Any
    majorants: Any

    def __init__(
        self,
        extinction: MitsubaObject,
        scale: JitFloat,
        albedo: MitsubaObject,
        emission: MitsubaObject,
    ) -> None:
        self.extinction, self.scale = extinction, scale
        self.albedo, self.emission, self.majorants = albedo, emission, None
        # The meaning of RGB if σ is a transfer function
        function = getattr(extinction, "function", None)
        self.colour = None if function is None else function.colour
        self.reflectance, self.light, self.white = (
            make_rgb_spectrum(),
            make_rgb_emission(),
            make_white_light(),
        )

    def update_majorants(self, local: bool) -> None:
        """Compute the majorants again, for coarse cells if `local`, otherwise one for all.

        Raises `BrdfkitError` if they do not bound the extinction, or if it is far too large.
        """
        with dr.suspend_grad():
            self.majorants = compute_majorants(self.extinction, self.scale, local)
            self.majorants.require(self.sigma, TESTED_POINTS)
        require_unit(self.majorants)

    def sigma(self, p: JitVector, active: JitMask = True) -> JitFloat:
        """Return the extinction σ at points `p`."""
        import mitsuba as mi

        it = dr.zeros(mi.Interaction3f)
        it.p = p
        return self.scale * self.extinction.eval_1(it, active)

    def coefficients(
        self, it: MitsubaObject, active: JitMask
    ) -> tuple[JitFloat, JitColour, JitColour]:
        """Return σ, α, and the radiance RGB that is emitted per σ and length."""
        import mitsuba as mi

        albedo, light = mi.unpolarized_spectrum(self.albedo.eval(it, active)), 0
        if self.colour is None:
            return self.sigma(it.p, active), albedo, light
        sigma, rgb = self.extinction.eval_extinction_and_colour(it, active)
        if self.colour == "albedo":
            albedo = albedo * self.reflectance(rgb, it)
        else:
            light = self.light(rgb, it)
        return self.scale * sigma, albedo, light

    def split_light(
        self, ray: MitsubaObject, end: JitFloat, sampler: MitsubaObject, active: JitMask
    ) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Return the shares of light that pass and that collide before `end`, and a collision.

        The first share has the derivatives of T, and is NaN where σ exceeds its majorant. The
        collision is a distance.
        """
        near, far = self.clip_to_box(ray, end)
        share, collided, t, _ = split_light(
            self.sigma, self.majorants, ray, near, far, sampler, active
        )
        depth = self.sample_depth(ray, end, sampler, active)
        return replace_grad(share, -share * depth), collided, t

    def transmittance(
        self, ray: MitsubaObject, end: JitFloat, sampler: MitsubaObject, active: JitMask
    ) -> JitFloat:
        """Return a random share of light, whose mean is T from the ray's origin to `end`."""
        near, far = self.clip_to_box(ray, end)
        share, _ = estimate_transmittance(
            self.sigma, self.majorants, ray, near, far, sampler, active
        )
        return replace_grad(share, -share * self.sample_depth(ray, end, sampler, active))

    def sample_emission(
        self,
        ray: MitsubaObject,
        end: JitFloat,
        sampler: MitsubaObject,
        active: JitMask,
        with_rgb: bool = False,
    ) -> JitColour:
        """Return the radiance of e, and of σ RGB if `with_rgb`, up to `end`, by a random place."""
        import mitsuba as mi

        near, far = self.clip_to_box(ray, end)
        length = dr.maximum(far - near, 0)
        t = near + sampler.next_1d(active) * length
        it = dr.zeros(mi.Interaction3f)
        it.p, it.wavelengths = ray(t), ray.wavelengths
        e = mi.unpolarized_spectrum(self.emission.eval(it, active)) * self.white(it)
        if with_rgb:
            sigma, _, light = self.coefficients(it, active)
            e += sigma * light
        return length * self.transmittance(ray, t, sampler, active) * e

    def sample_depth(
        self, ray: MitsubaObject, end: JitFloat, sampler: MitsubaObject, active: JitMask
    ) -> JitFloat:
        """Return an estimate of the optical depth of rays up to `end`, by σ at a random place."""
        near, far = self.clip_to_box(ray, end)
        length = dr.maximum(far - near, 0)
        return length * self.sigma(ray(near + sampler.next_1d(active) * length), active)

    def clip_to_box(self, ray: MitsubaObject, end: JitFloat) -> tuple[JitFloat, JitFloat]:
        """Return where rays enter and leave the box, up to `end`."""
        near, far = intersect_box(ray, self.extinction)
        return near, dr.minimum(far, end)


def require_unit(majorants: Majorants) -> None:
    """Raise `BrdfkitError` if bounds are so large for their box that no ray would pass it."""
    collisions = float(majorants.values.max()) * np.linalg.norm(majorants.cube_to_world[:3, :3])
    if collisions > COLLISION_LIMIT:
        raise BrdfkitError(
            f"The extinction reaches {majorants.values.max():.3g} per unit of length, and light "
            f"would collide {collisions:.2g} times across the volume, which takes forever; check "
            "the unit of length, or lower the extinction."
        )
