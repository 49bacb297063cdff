"""What the fits of the leaderboard are held to: the truth of a material, from `.eval` alone."""

import numpy as np
from brdfkit.theses.kurt2007.neural import evaluate_network

import brdfkit as bk
from brdfkit.core.geometry.directions import from_half_difference, to_half_difference
from brdfkit.materials.measured.selection import select_samples

MAX_ANGLE, PAIRS = 80.0, 60_000


def directions():
    """`PAIRS` pairs (wi, wo), uniform in half/difference angles, both below `MAX_ANGLE`."""
    rng = np.random.default_rng(0)
    theta_h, theta_d, phi_d = rng.random((3, 4 * PAIRS)) * [[np.pi / 2], [np.pi / 2], [np.pi]]
    pair = from_half_difference(theta_h, theta_d, phi_d)
    within = np.all([w[:, 2] > np.cos(np.radians(MAX_ANGLE)) for w in pair], axis=0)
    return [w[within][:PAIRS] for w in pair]


class Truth:
    """The values to which the fits of one material are held, and where: wi, wo (n, 3).

    A network is asked itself, RGL's files by their own lookup; of goniometer data, which have
    nothing between their samples, the samples count.
    """

    def __init__(self, file, networks):
        if file.stem in networks:
            self.wi, self.wo = directions()
            angles = to_half_difference(self.wi, self.wo)
            values = evaluate_network(networks[file.stem], *angles)
        elif (data := bk.load(file).rgb).has_lookup:
            self.wi, self.wo = directions()
            values = data.eval(self.wi, self.wo)
        else:
            samples = select_samples(data, MAX_ANGLE)
            self.wi, self.wo, values = samples.wi, samples.wo, samples.values
        self.cosines = (self.wi[:, 2] * self.wo[:, 2])[:, None]
        self.logarithms = self._logarithms(values)

    def error(self, fit):
        """RMS of ln((f cosθ_i cosθ_o + 0.001) / (g cosθ_i cosθ_o + 0.001)) over R, G, B."""
        found = self._logarithms(fit.eval(self.wi, self.wo))
        return float(np.sqrt(np.mean((found - self.logarithms) ** 2)))

    def _logarithms(self, values):
        return np.log(np.maximum(values, 0) * self.cosines + 1e-3)
