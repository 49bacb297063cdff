"""Lafortune: cosine lobes about the mirror direction, about others, or back towards the light.

    f = k_d / π + Σ_j k_s (n + 2) / 2π [C_x l_x v_x + C_y l_y v_y + C_z l_z v_z]₊ⁿ
                      / max(|C_x|, |C_y|, |C_z|)ⁿ

l and v are the directions of light and view, with z along the normal; n is the sharpness of the
lobe, and [x]₊ = max(x, 0). [Lafortune et al. 1997]; [Kurt 2007, eqs. 3.10-3.12]. Only the ratios of
C_x, C_y and C_z matter: with -C_x = -C_y = C_z the lobe is Phong's, with C_z < -C_x it peaks below
the mirror direction, with C_x > 0 it reflects back to the light, and with C_x ≠ C_y it is
anisotropic. The option `lobe_count` is the number of lobes in the sum. The weight k_s is the albedo
of a mirror lobe at normal incidence; other lobes reflect less. It suits rough surfaces with
off-specular peaks or retro-reflection. Highlights are round, never elliptic, and there is no
Fresnel effect.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import dot
from brdfkit.model import Model, Parameter, follows, option, shape, weight
from brdfkit.model.lobes import Lobe, PowerLobe, lambertian
from brdfkit.model.numerics import cosine_power

# The ball in the picture on the model's page: reflective tape, which sends light back
PICTURE = {
    "diffuse_reflectance": [0.3, 0.22, 0.02],
    "specular_reflectance": 0.6,
    "c_x": 0.7,
    "c_z": 0.7,
    "exponent": 12.0,
}


class Lafortune(Model):
    lobe_count = option(1, (1, 2, 3), "S: the number of lobes")
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.3, "k_s: strength of the lobe")
    # The lower bound of C_z keeps the lobe's axis above the surface; ratios to C_z may reach 1000
    c_x = shape(-0.7, (-1.0, 1.0), "C_x: below 0 towards the mirror direction, above 0 back")
    c_y = follows("c_x", c_x, "C_y: like C_x, along y")
    c_z = shape(0.68, (0.001, 1.0), "C_z: along the normal; only the ratios to C_x and C_y matter")
    exponent = shape(30.0, (0.1, 1e4), "n: sharpness of the lobe", log=True, width=-0.5)

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter | None]:
        more: dict[str, Parameter | None] = {}
        for j in range(2, cls.lobe_count + 1):
            # Each lobe starts wider than the one before, as equal lobes are a saddle point of a fit
            more |= {
                f"specular_reflectance_{j}": weight(0.1, f"k_s: strength of lobe {j}"),
                f"c_x_{j}": (c_x := shape(-0.7, (-1.0, 1.0), f"C_x of lobe {j}")),
                f"c_y_{j}": follows(f"c_x_{j}", c_x, f"C_y of lobe {j}"),
                f"c_z_{j}": shape(0.68, (0.001, 1.0), f"C_z of lobe {j}"),
                f"exponent_{j}": shape(
                    30.0 / 5 ** (j - 1), (0.1, 1e4), f"n of lobe {j}", log=True, width=-0.5
                ),
            }
        return more

    def lobes(self) -> tuple[Lobe, ...]:
        endings = ["", *(f"_{j}" for j in range(2, self.lobe_count + 1))]
        names = ("c_x", "c_y", "c_z", "exponent")
        return lambertian(), *(make_lobe(*(getattr(self, n + e) for n in names)) for e in endings)


def make_lobe(c_x: JitFloat, c_y: JitFloat, c_z: JitFloat, n: JitFloat) -> Lobe:
    """Make one lobe of the sum, with the factors C_x, C_y, C_z and the exponent n."""
    largest = dr.maximum(dr.maximum(dr.abs(c_x), dr.abs(c_y)), c_z)
    a_x, a_y, a_z = (ratio_to_largest(c, largest) for c in (c_x, c_y, c_z))

    def lobe_value(wi: JitVector, wo: JitVector) -> JitFloat:
        # 1 minus the bracket of the formula; this sum is accurate where the bracket is close to 1
        complement = (
            complement_term(a_x, wi.x, wo.x)
            + complement_term(a_y, wi.y, wo.y)
            + complement_term(a_z, wi.z, wo.z)
        )
        return (n + 2) / (2 * dr.pi) * cosine_power(complement, n)

    def lobe_axis(wi: JitVector) -> JitVector:
        c = type(wi)(a_x * wi.x, a_y * wi.y, a_z * wi.z)
        return c * dr.rsqrt(dot(c, c))

    def energy(wi: JitVector) -> JitFloat:
        # The bracket is |(a_x l_x, a_y l_y, a_z l_z)| times the cosine of the angle to the axis
        x, y, z = wi.x * wi.x, wi.y * wi.y, wi.z * wi.z
        lost = (1 - a_x * a_x) * x + (1 - a_y * a_y) * y + (1 - a_z * a_z) * z
        return cosine_power(lost, n / 2) * sampling.energy(wi)

    sampling = PowerLobe(lobe_axis, n)
    return Lobe(lobe_value, sampling, energy)


def ratio_to_largest(c: JitFloat, largest: JitFloat) -> JitFloat:
    """Return c / largest; it is ±1 without a derivative if `c` itself is the largest."""
    sign = dr.select(c < 0, -1, 1)
    return dr.select(dr.abs(c) == largest, sign, c / largest)


def complement_term(a: JitFloat, l: JitFloat, v: JitFloat) -> JitFloat:
    """Return (l² + v²)/2 - a l v, without loss of digits where a ≈ ±1 and l ≈ ±v.

    Summed over x, y and z of two unit vectors l and v, this is 1 - Σ a l v.
    """
    sign = dr.select(a < 0, -1, 1)
    d = l - sign * v
    return 0.5 * d * d + (sign - a) * l * v
