"""`Medium`: the matter in the box of a volume, and what it does to light along rays.

Places are drawn without derivatives, by `tracking.py`; what is found there has them. Light f from a
collision at t, which has the density σ(t) T(t), T = exp(-τ), has the derivative

    ∂(f σ T) / (σ T) = ∂f + f (∂σ(t)/σ(t) - ∂τ),   ∂τ = ∫ ∂σ ds from 0 to t = mean of t ∂σ(ut)

for u even in [0, 1), and the share T that comes through has -T ∂τ. So one more look-up, at one u,
makes each unbiased, also where σ meets its majorant and null collisions have no derivative. Nothing
collides where σ = 0: there only ∂τ is found.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.channels import emission_of_rgb, spectrum_of_rgb, white
from brdfkit.volumes.light.majorants import extinction_bounds
from brdfkit.volumes.light.tracking import divide, transmittance
from brdfkit.volumes.rays.along_ray import within

TESTED = 1 << 14  # points at which an extinction is held against its majorants
MOST_COLLISIONS = 1e6  # across a box; of smaller steps single precision loses some, and all in time


@dataclass(init=False, eq=False)
class Medium:
    """The matter of volumes of Mitsuba's, for its current variant.

    extinction : σ; its box bounds all. A `transfer_function` has RGB as well.
    scale : a factor of σ.
    albedo : α, the share of what collides that is scattered; times RGB where that is an albedo.
    emission : e, radiance that is added per length.
    majorants : bounds of σ, from `bound` on.
    """

    extinction: Any
    scale: Any
    albedo: Any
    emission: Any
    majorants: Any

    def __init__(self, extinction, scale, albedo, emission):
        self.extinction, self.scale = extinction, scale
        self.albedo, self.emission, self.majorants = albedo, emission, None
        # What RGB of a transfer function means
        function = getattr(extinction, "function", None)
        self.colour = None if function is None else function.colour
        self.reflectance, self.light, self.white = spectrum_of_rgb(), emission_of_rgb(), white()

    def bound(self, local):
        """Find the majorants anew: those of coarse cells if `local`, else one.

        Raises `BrdfkitError` for an extinction that they do not bound, or that is in another unit.
        """
        with dr.suspend_grad():
            self.majorants = extinction_bounds(self.extinction, self.scale, local)
            self.majorants.require(self.sigma, TESTED)
        require_unit(self.majorants)

    def sigma(self, p, active=True):
        """σ at points."""
        import mitsuba as mi

        it = dr.zeros(mi.Interaction3f)
        it.p = p
        return self.scale * self.extinction.eval_1(it, active)

    def matter(self, it, active):
        """σ, α, and the light that σ RGB is: e / σ."""
        import mitsuba as mi

        albedo, light = mi.unpolarized_spectrum(self.albedo.eval(it, active)), 0
        if self.colour is None:
            return self.sigma(it.p, active), albedo, light
        sigma, rgb = self.extinction.optics(it, active)
        if self.colour == "albedo":
            albedo = albedo * self.reflectance(rgb, it)
        else:
            light = self.light(rgb, it)
        return self.scale * sigma, albedo, light

    def divide(self, ray, end, sampler, active):
        """The share of light that comes through before `end`, that which collides, and where.

        The first has the derivatives of T, and is NaN where σ was above its majorant.
        """
        near, far = self.inside(ray, end)
        share, collided, t, _ = divide(self.sigma, self.majorants, ray, near, far, sampler, active)
        depth = self.depth(ray, end, sampler, active)
        return dr.replace_grad(share, -share * depth), collided, t

    def transmittance(self, ray, end, sampler, active):
        """A random share of light, of the mean T from the ray's origin to `end`."""
        near, far = self.inside(ray, end)
        share, _ = transmittance(self.sigma, self.majorants, ray, near, far, sampler, active)
        return dr.replace_grad(share, -share * self.depth(ray, end, sampler, active))

    def glow(self, ray, end, sampler, active, own=False):
        """The radiance that e adds along rays, from a random place. With `own`, σ RGB as well."""
        import mitsuba as mi

        near, far = self.inside(ray, end)
        length = dr.maximum(far - near, 0)
        t = near + sampler.next_1d(active) * length
        it = dr.zeros(mi.Interaction3f)
        it.p, it.wavelengths = ray(t), ray.wavelengths
        e = mi.unpolarized_spectrum(self.emission.eval(it, active)) * self.white(it)
        if own:
            sigma, _, light = self.matter(it, active)
            e += sigma * light
        return length * self.transmittance(ray, t, sampler, active) * e

    def depth(self, ray, end, sampler, active):
        """The optical depth of rays up to `end`, by σ at a random place."""
        near, far = self.inside(ray, end)
        length = dr.maximum(far - near, 0)
        return length * self.sigma(ray(near + sampler.next_1d(active) * length), active)

    def inside(self, ray, end):
        """The part of rays, up to `end`, within the box."""
        near, far = within(ray, self.extinction)
        return near, dr.minimum(far, end)


def require_unit(majorants):
    """Raise `BrdfkitError` for bounds so large for their box that no ray would get through it."""
    collisions = float(majorants.values.max()) * np.linalg.norm(majorants.cube_to_world[:3, :3])
    if collisions > MOST_COLLISIONS:
        raise BrdfkitError(
            f"The extinction reaches {majorants.values.max():.3g} per unit of length, and light "
            f"would collide {collisions:.2g} times across the volume, which takes forever; check "
            "the unit of length, or lower the extinction."
        )
