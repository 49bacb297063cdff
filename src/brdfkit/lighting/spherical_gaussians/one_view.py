"""BRDF × cosine for one view: a diffuse part, and a glossy part as weighted directions.

    f(i, o) cosθ_i = ρ_d cosθ_i / π + glossy part,  glossy part ≥ 0

with the light's direction i at the polar angle θ_i, the view o, and the diffuse albedo ρ_d. The
diffuse part is the floor of f: the largest constant that exceeds f by at most a thousandth of the
reflected light, so that a few low values, as measurements have them, do not pull it down.
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
# A method's result for a view: albedo of the diffuse part (channels,), and the lobes' integrals
# (lobes, channels), axes (lobes, 3) and concentrations κ (lobes,)
ViewLobes = tuple[FloatArray, FloatArray, FloatArray, FloatArray]

RINGS = 48  # half the number of rings: lobes of 0.01 rad are resolved up to 80°
FLOOR_EXCESS = 1e-3  # share of the reflected light that the floor may add where f is lower
OMITTED_LIGHT = 1e-3  # share of the glossy light that fits leave out, in the darkest directions


@dataclass(frozen=True)
class OneView:
    """The diffuse albedo (channels,) at a `view` (3,), and the glossy part around it.

    The glossy part [sr⁻¹] has values (n, channels) at `directions` (n, 3), on rings about the
    mirror direction, each for its `solid_angle` (n,) [sr]. All directions are turned about z so
    that the view has azimuth 0.
    """

    view: FloatArray
    diffuse: FloatArray
    directions: FloatArray
    solid_angle: FloatArray
    glossy: FloatArray

    @property
    def energy(self) -> FloatArray:
        """The light (n, channels) of each direction, whose sum is the albedo of the glossy part."""
        return self.glossy * self.solid_angle[:, None]

    @property
    def means(self) -> FloatArray:
        """The mean directions (n, 3) of round caps as large as each direction's solid angle Ω.

        Their length is 1 - Ω / 4π.
        """
        return self.directions * (1 - self.solid_angle[:, None] / (4 * np.pi))

    def samples(self) -> tuple[FloatArray, FloatArray]:
        """Return the samples of a fit: `means` (m, 3), and the light of all channels (m,).

        The darkest directions are left out to save time. A black glossy part has cosine weights.
        """
        weights = self.energy.mean(axis=1) + 1e-9 * self.directions[:, 2] * self.solid_angle
        order = weights.argsort()
        kept = order[weights[order].cumsum() > OMITTED_LIGHT * weights.sum()]
        return self.means[kept], weights[kept]


def sample_view(brdf: Brdf, theta: float, phi: float) -> OneView:
    """Evaluate `brdf(wi, wo)`, which gives (n, channels) [sr⁻¹], for the view at θ and φ [rad]."""
    view = from_angles(theta, 0)
    directions, cosine = make_ring_rule(view, RINGS)  # solid angles times cosθ
    wi, wo = rotate_z(directions, phi), rotate_z(view, phi)
    values = np.asarray(brdf(wi, np.broadcast_to(wo, wi.shape)), float)
    if values.ndim != 2 or not np.isfinite(values).all():
        raise BrdfkitError(
            f"The BRDF should be finite numbers of shape (n, channels); seen from {wo.round(3)}, "
            "it is not: check the material."
        )
    values = np.maximum(values, 0)
    glossy = np.maximum(values - _find_floor(values, cosine), 0)
    diffuse = np.maximum(cosine @ (values - glossy), 0)
    solid_angle = cosine / directions[:, 2]
    return OneView(view, diffuse, directions, solid_angle, glossy * directions[:, 2:])


def _find_floor(values: FloatArray, cosine: FloatArray) -> FloatArray:
    """Return the largest c (channels,) with Σ max(c - f, 0) cosθ ΔΩ ≤ FLOOR_EXCESS · Σ f cosθ ΔΩ.

    `values` are f (n, channels), `cosine` is cosθ ΔΩ (n,).
    """
    order = values.argsort(axis=0)
    f, weight = np.take_along_axis(values, order, axis=0), cosine[order]
    below, light = weight.cumsum(axis=0), (weight * f).cumsum(axis=0)
    # If c lay between the values j and j + 1, the sum would be c · below[j] - light[j]
    c = (FLOOR_EXCESS * light[-1] + light) / below
    between = np.vstack([f[1:], np.full(f.shape[1], np.inf)]) >= c
    return np.take_along_axis(c, between.argmax(axis=0)[None], axis=0)[0]
