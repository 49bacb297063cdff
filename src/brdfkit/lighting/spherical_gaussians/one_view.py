"""BRDF × cosine as one view sees it: a diffuse part, and the rest as weighted directions.

    f(i, o) cosθ_i = ρ_d cosθ_i / π + rest,  rest ≥ 0

The diffuse part is the floor of f: the highest constant that is above f by at most a thousandth of
what is reflected, so that a few low values, as measurements have them, do not pull it down.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles, rotate_z
from brdfkit.core.geometry.quadrature import ring_rule

RINGS = 48  # half their number: lobes of 0.01 rad are resolved up to 80°
ABOVE = 1e-3  # how much of the reflected light the floor may add where f is lower
LEFT_OUT = 1e-3  # of the light of the rest: what the darkest directions hold, in fits


@dataclass(frozen=True)
class OneView:
    """The diffuse albedo (channels,), and the rest [sr⁻¹] on rings about the mirror direction.

    Each of the directions (n, 3) stands for its solid angle (n,) and has values (n, channels).
    They are turned about z so that the `view` has azimuth 0.
    """

    view: np.ndarray
    diffuse: np.ndarray
    directions: np.ndarray
    solid_angle: np.ndarray
    rest: np.ndarray

    @property
    def energy(self):
        """The light (n, channels) of each direction, whose sum is the albedo of the rest."""
        return self.rest * self.solid_angle[:, None]

    @property
    def means(self):
        """(n, 3): the mean of the directions of a round cap of each one's solid angle Ω.

        Its length is 1 - Ω / 4π.
        """
        return self.directions * (1 - self.solid_angle[:, None] / (4 * np.pi))

    def samples(self):
        """What a mixture is fitted to: means (m, 3), and weights (m,), the light of all channels.

        Without the darkest directions, to save time. Of a black rest the weights are a cosine.
        """
        weights = self.energy.mean(axis=1) + 1e-9 * self.directions[:, 2] * self.solid_angle
        order = weights.argsort()
        kept = order[weights[order].cumsum() > LEFT_OUT * weights.sum()]
        return self.means[kept], weights[kept]


def one_view(brdf, theta, phi):
    """What a view at angles θ and φ sees of `brdf(wi, wo)`, which gives (n, channels) in sr⁻¹."""
    view = from_angles(theta, 0)
    directions, cosine = ring_rule(view, RINGS)  # solid angles times cosθ
    wi, wo = rotate_z(directions, phi), rotate_z(view, phi)
    values = np.asarray(brdf(wi, np.broadcast_to(wo, wi.shape)), float)
    if values.ndim != 2 or not np.isfinite(values).all():
        raise BrdfkitError(
            f"The BRDF should be finite numbers of shape (n, channels); seen from {wo.round(3)}, "
            "it is not: check the material."
        )
    values = np.maximum(values, 0)
    rest = np.maximum(values - _floor(values, cosine), 0)
    diffuse = np.maximum(cosine @ (values - rest), 0)
    solid_angle = cosine / directions[:, 2]
    return OneView(view, diffuse, directions, solid_angle, rest * directions[:, 2:])


def _floor(values, cosine):
    """The highest c (channels,) with Σ max(c - f, 0) cosθ ΔΩ ≤ ABOVE · Σ f cosθ ΔΩ."""
    order = values.argsort(axis=0)
    f, weight = np.take_along_axis(values, order, axis=0), cosine[order]
    below, light = weight.cumsum(axis=0), (weight * f).cumsum(axis=0)
    # Were c between the values j and j + 1, the sum would be c · below[j] - light[j]
    c = (ABOVE * light[-1] + light) / below
    between = np.vstack([f[1:], np.full(f.shape[1], np.inf)]) >= c
    return np.take_along_axis(c, between.argmax(axis=0)[None], axis=0)[0]
