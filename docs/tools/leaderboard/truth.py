"""Computes the true values of a material, with which fits of the leaderboard are compared."""

import numpy as np
from brdfkit.theses.kurt2007.neural import evaluate_network

import brdfkit as bk
from brdfkit.core.geometry.directions import from_half_difference, to_half_difference
from brdfkit.materials.measured.selection import select_samples

MAX_ANGLE, PAIRS = 80.0, 60_000


def draw_directions():
    """Return `PAIRS` pairs (wi, wo) below `MAX_ANGLE`, uniform in half and difference angles."""
    rng = np.random.default_rng(0)
    theta_h, theta_d, phi_d = rng.random((3, 4 * PAIRS)) * [[np.pi / 2], [np.pi / 2], [np.pi]]
    pair = from_half_difference(theta_h, theta_d, phi_d)
    within = np.all([w[:, 2] > np.cos(np.radians(MAX_ANGLE)) for w in pair], axis=0)
    return [w[within][:PAIRS] for w in pair]


class Truth:
    """The true values of one material at n pairs of directions wi, wo (n, 3).

    The truth of a neural reconstruction is its network, and the truth of RGL's files is their own
    interpolation. Goniometer data have nothing between their samples, so the samples are the truth.
    `file`: file of the material; `networks`: networks by the name of the material.
    """

    def __init__(self, file, networks):
        if file.stem in networks:
            self.wi, self.wo = draw_directions()
            angles = to_half_difference(self.wi, self.wo)
            values = evaluate_network(networks[file.stem], *angles)
        elif (data := bk.load(file).rgb).has_lookup:
            self.wi, self.wo = draw_directions()
            values = data.eval(self.wi, self.wo)
        else:
            samples = select_samples(data, MAX_ANGLE)
            self.wi, self.wo, values = samples.wi, samples.wo, samples.values
        self.cosines = (self.wi[:, 2] * self.wo[:, 2])[:, None]
        self.logarithms = self._compute_logarithms(values)

    def compute_error(self, fit):
        """Return the error of a fit, the root mean square over directions and R, G, B of

        ln((f cosθ_i cosθ_o + 0.001) / (g cosθ_i cosθ_o + 0.001)), with the fit f and the truth g.
        """
        found = self._compute_logarithms(fit.eval(self.wi, self.wo))
        return float(np.sqrt(np.mean((found - self.logarithms) ** 2)))

    def _compute_logarithms(self, values):
        return np.log(np.maximum(values, 0) * self.cosines + 1e-3)
