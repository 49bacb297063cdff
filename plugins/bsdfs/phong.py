"""Phong: a highlight that is a power of the cosine between mirror direction and view.

    f = k_d / π + k_s (n + 2) / 2π (cos α)ⁿ,   cos α = max(0, R·V),   R = 2 (N·L) N - L

N, L and V are the normal and the directions of light and view. [Phong 1975] in the reciprocal form
of [Lafortune & Willems 1994]; [Kurt 2007, eqs. 3.2, 3.3]. Energy is conserved for k_d + k_s ≤ 1. It
suits plastics seen from above, and has no retro-reflection. Towards grazing angles its highlights
stay round and grow darker, while highlights of real materials grow long and bright.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import one_minus_dot
from brdfkit.model import Model, shape, weight
from brdfkit.model.lobes import Lobe, PowerLobe, lambertian
from brdfkit.model.numerics import cosine_power

# The ball in the picture on the model's page: red plastic
PICTURE = {
    "diffuse_reflectance": [0.45, 0.03, 0.03],
    "specular_reflectance": 0.15,
    "exponent": 80.0,
}


class Phong(Model):
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.3, "k_s: albedo of the highlight at normal incidence")
    exponent = shape(30.0, (0.1, 1e4), "n: sharpness of the highlight", log=True, width=-0.5)

    def highlight(self, wi: JitVector, wo: JitVector) -> JitFloat:
        power = cosine_power(one_minus_dot(mirror_direction(wi), wo), self.exponent)
        return (self.exponent + 2) / (2 * dr.pi) * power

    def lobes(self) -> tuple[Lobe, ...]:
        sampling = PowerLobe(mirror_direction, self.exponent)
        return lambertian(), Lobe(self.highlight, sampling, sampling.energy)


def mirror_direction(w: JitVector) -> JitVector:
    """Return the mirror direction R of the direction `w` about the normal."""
    return type(w)(-w.x, -w.y, w.z)
