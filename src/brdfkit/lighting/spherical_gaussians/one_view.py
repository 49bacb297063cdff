"""BRDF × cosine for one view: a diffuse part, and a glossy part as weighted directions.

    f(i, o) cosθ_i = ρ_d cosθ_i / π + glossy part,  glossy part ≥ 0

with the BRDF f, the light's direction i at the polar angle θ_i, the view o, and the diffuse albedo
ρ_d. The diffuse part is the floor of f: nearly its smallest value, but a thousandth of the
reflected light may lie below, so that a few low values of a measurement do not determine it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles, rotate_z
from brdfkit.core.geometry.quadrature import make_ring_rule

Brdf = Callable[[FloatArray, FloatArray], FloatArray]
# The lobes that a method fits to a view: albedo of the diffuse part (channels,), and the lobes'
# integrals (lobes, channels), axes (lobes, 3) and concentrations κ (lobes,)
ViewLobes = tuple[FloatArray, FloatArray, FloatArray, FloatArray]

# Half the number of rings of directions around the mirror direction; it resolves lobes of 0.01 rad
# for views at up to 80°
RINGS = 48
# The diffuse part may exceed low BRDF values, by at most this share of the reflected light
FLOOR_EXCESS = 1e-3
OMITTED_LIGHT = 1e-3  # share of the glossy light that fits ignore: that in the darkest directions


@dataclass(frozen=True)
class OneView:
    """BRDF × cosine for the `view` (3,), as the albedo of a diffuse part and a glossy part.

    `diffuse` is that albedo (channels,). `glossy` (n, channels) [sr⁻¹] are the values at
    `directions` (n, 3) on rings about the mirror direction, each of which represents its
    `solid_angle` (n,) [sr]. All directions are turned about z so that the view has azimuth 0.
    """

    view: FloatArray
    diffuse: FloatArray
    directions: FloatArray
    solid_angle: FloatArray
    glossy: FloatArray

    @property
    def energy(self) -> FloatArray:
        """The glossy part times each direction's solid angle (n, channels): its share of light."""
        return self.glossy * self.solid_angle[:, None]

    @property
    def mean_directions(self) -> FloatArray:
        """The mean vectors (n, 3) of spherical caps about the directions, for fits of lobes.

        A cap has the solid angle Ω that its direction represents, and its mean the length
        1 - Ω / 4π.
        """
        return self.directions * (1 - self.solid_angle[:, None] / (4 * np.pi))

    def samples(self) -> tuple[FloatArray, FloatArray]:
        """Return the samples to which lobes are fitted: vectors (m, 3), and their weights (m,).

        Weights are the glossy light, averaged over the channels; a black glossy part has cosine
        weights. The darkest directions are left out to save time.
        """
        weights = self.energy.mean(axis=1) + 1e-9 * self.directions[:, 2] * self.solid_angle
        order = weights.argsort()
        kept = order[weights[order].cumsum() > OMITTED_LIGHT * weights.sum()]
        return self.mean_directions[kept], weights[kept]


def sample_view(brdf: Brdf, theta: float, phi: float) -> OneView:
    """Evaluate a BRDF for the view at the polar angle `theta` and the azimuth `phi` [rad].

    `brdf(wi, wo)` returns values (n, channels) [sr⁻¹] for pairs of directions (n, 3).
    """
    view = from_angles(theta, 0)
    directions, cosine = make_ring_rule(view, RINGS)  # `cosine` is the solid angle times cosθ
    wi, wo = rotate_z(directions, phi), rotate_z(view, phi)
    values = np.asarray(brdf(wi, np.broadcast_to(wo, wi.shape)), float)
    if values.ndim != 2 or not np.isfinite(values).all():
        raise BrdfkitError(
            "The BRDF should be finite numbers of shape (n, channels), but it is not for the view "
            f"{wo.round(3)}: check the material."
        )
    values = np.maximum(values, 0)
    glossy = np.maximum(values - _find_diffuse_floor(values, cosine), 0)
    diffuse = np.maximum(cosine @ (values - glossy), 0)
    solid_angle = cosine / directions[:, 2]
    return OneView(view, diffuse, directions, solid_angle, glossy * directions[:, 2:])


def _find_diffuse_floor(values: FloatArray, cosine: FloatArray) -> FloatArray:
    """Return the diffuse part c (channels,) of BRDF values, nearly their minimum.

    The `values` f (n, channels) belong to directions with the solid angles ΔΩ, and `cosine` (n,) is
    cosθ ΔΩ. The diffuse part is the largest c that exceeds low values by a small share of the
    reflected light: Σ max(c - f, 0) cosθ ΔΩ ≤ FLOOR_EXCESS · Σ f cosθ ΔΩ.
    """
    order = values.argsort(axis=0)
    f, weight = np.take_along_axis(values, order, axis=0), cosine[order]
    below, light = weight.cumsum(axis=0), (weight * f).cumsum(axis=0)
    # For c between the sorted values j and j + 1, Σ max(c - f, 0) cosθ ΔΩ = c below[j] - light[j]
    c = (FLOOR_EXCESS * light[-1] + light) / below
    between = np.vstack([f[1:], np.full(f.shape[1], np.inf)]) >= c
    return np.take_along_axis(c, between.argmax(axis=0)[None], axis=0)[0]
