"""PCA polynomial: a polynomial in the principal components of products of the two directions.

    isotropic    f = β_0 + Σ_k (β_{2k-1} Z_1^k + β_{2k} Z_2^k)
                 Z = W U,  W_1 = l_x v_x + l_y v_y,  W_2 = l_z v_z
    anisotropic  f = β_0 + Σ_k (β_{3k-2} Z_1^k + β_{3k-1} Z_2^k + β_{3k} Z_3^k)
                 Z = X U,  X_1 = l_x v_x,  X_2 = l_y v_y,  X_3 = l_z v_z

l and v are the directions of light and view, with z along the normal; k = 1 ... `degree`. The
matrix U rotates the products to their principal axes over the measured directions. A fit computes U
from these directions, and the fitted material keeps it as angles [rad]. Weights may be negative; a
sum below 0 is clamped at 0. The interactions Z_1^j Z_2^k are left out, as in the paper, although
uncorrelated components may well interact.

[Öztürk et al. 2008]; [Kurt 2007, eqs. 7.4, 7.5]. It suits diffuse and rough materials. A highlight
needs a high degree, with which the polynomial swings below 0 in other directions.
"""

import math
from collections.abc import Sequence

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitVector
from brdfkit.model import Model, Parameter, option, shape, weight
from brdfkit.model.lobes import Cosine, Lobe
from brdfkit.model.samples import Samples

# The ball in the picture on the model's page: a dull metal, GGX of alpha 0.55, fitted
PICTURE = {
    "beta_0": [0.141, 0.099, 0.051],
    "beta_1": [-0.14, -0.096, -0.047],
    "beta_2": [-0.171, -0.118, -0.057],
    "beta_3": [0.433, 0.298, 0.144],
    "beta_4": [0.555, 0.382, 0.185],
    "beta_5": [-0.592, -0.408, -0.197],
    "beta_6": [-0.169, -0.117, -0.056],
    "angle_1_2": 0.492,
}
# Number of components → pairs of axes, the planes in which the angles rotate one after the other
PLANES = {2: ((0, 1),), 3: ((0, 1), (0, 2), (1, 2))}


def multiply_coordinates(wi: JitVector, wo: JitVector, components: int) -> list[JitFloat]:
    """Return the products of two directions' coordinates.

    They are [x x' + y y', z z'] for 2 `components` (W), and [x x', y y', z z'] for 3 (X).
    """
    x, y, z = wi.x * wo.x, wi.y * wo.y, wi.z * wo.z
    return [x + y, z] if components == 2 else [x, y, z]


def rotate_to_axes(products: Sequence[JitFloat], angles: Sequence[JitFloat]) -> list[JitFloat]:
    """Rotate the `products` to the principal axes, which the `angles` [rad] give."""
    z = list(products)
    for (a, b), angle in zip(PLANES[len(z)], angles, strict=True):
        sine, cosine = dr.sin(angle), dr.cos(angle)
        z[a], z[b] = cosine * z[a] + sine * z[b], cosine * z[b] - sine * z[a]
    return z


def find_rotation_angles(axes: FloatArray) -> list[float]:
    """Return the angles [rad] that rotate the coordinate axes onto `axes`, orthonormal rows."""
    if np.linalg.det(axes) < 0:  # a rotation needs det > 0; signs are arbitrary
        axes = np.vstack([axes[:-1], -axes[-1]])
    angles = [math.atan2(axes[0, 1], axes[0, 0])]
    if len(axes) == 3:
        angles.append(math.atan2(axes[0, 2], math.hypot(axes[0, 0], axes[0, 1])))
        angles.append(math.atan2(axes[1, 2], axes[2, 2]))
    return angles


class PCAPolynomial(Model):
    degree = option(3, tuple(range(1, 17)), "p, the degree")
    symmetry = option(
        "isotropic", ("isotropic", "anisotropic"), "whether f changes as the surface turns"
    )

    @classmethod
    def component_count(cls) -> int:
        return 2 if cls.symmetry == "isotropic" else 3

    @classmethod
    def list_angle_names(cls) -> list[str]:
        return [f"angle_{a + 1}_{b + 1}" for a, b in PLANES[cls.component_count()]]

    @classmethod
    def list_powers(cls) -> list[tuple[int, int]]:
        """Return for each β_1, β_2, ... the index of its component Z, from 0, and the exponent."""
        return [(j, k) for k in range(1, cls.degree + 1) for j in range(cls.component_count())]

    @classmethod
    def is_anisotropic(cls) -> bool:
        return cls.symmetry == "anisotropic"

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter | None]:
        signed = (-math.inf, math.inf)
        constant = {"beta_0": weight(0.15, "β_0: constant", signed)}
        betas = {
            f"beta_{number}": weight(0.0, f"β_{number}: weight of Z_{j + 1}^{k}", signed)
            for number, (j, k) in enumerate(cls.list_powers(), 1)
        }
        angles = {
            name: shape(0.0, (-math.pi, math.pi), "turn of the principal axes in this plane [rad]")
            for name in cls.list_angle_names()
        }
        return constant | betas | angles

    @classmethod
    def determine_parameters(cls, samples: Samples) -> dict[str, float]:
        """Return the angles, by name, that turn the coordinate axes to the principal axes.

        The principal axes are those of the products of `samples.wi` and `samples.wo`, component by
        component, so the angles need no search.
        """
        data = samples.wi * samples.wo
        if cls.component_count() == 2:
            data = np.stack([data[:, 0] + data[:, 1], data[:, 2]], axis=1)
        variances, axes = np.linalg.eigh(np.cov(data.T, ddof=0))
        axes = axes[:, np.argsort(-variances)].T
        axes = axes * np.sign(axes[range(len(axes)), np.abs(axes).argmax(axis=1)])[:, None]
        return dict(zip(cls.list_angle_names(), find_rotation_angles(axes), strict=True))

    def lobes(self) -> tuple[Lobe, ...]:
        cosine = Cosine()
        angles = [getattr(self, name) for name in self.list_angle_names()]

        def make_power_lobe(j: int, k: int) -> Lobe:
            def lobe_value(wi: JitVector, wo: JitVector) -> JitFloat:
                return (
                    rotate_to_axes(multiply_coordinates(wi, wo, self.component_count()), angles)[j]
                    ** k
                )

            return Lobe(lobe_value, cosine, lambda wi: 0.0, diffuse=True)

        constant = Lobe(lambda wi, wo: 1.0, cosine, lambda wi: math.pi, diffuse=True)
        return constant, *(make_power_lobe(j, k) for j, k in self.list_powers())
