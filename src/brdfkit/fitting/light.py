"""The light that a fit reflects, beside that of its data; and fits that keep it.

A loss compares values, and a model that cannot meet them all may end with far too much light or too
little: where grazing angles are missing, a highlight falls between the samples, or a material
reflects light back. Such a fit is searched once more, with a term for its light,

    E² / E₀² + SHARE · mean over θ_i and channels of ((a - a*) / ā*)²,

a being the model's albedo and a* the data's, ā* its mean over the channels, and E₀ the error of the
first search. A fit whose light is right is left as it is.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from brdfkit.fitting.blocks import Blocks
from brdfkit.fitting.loss import Loss
from brdfkit.fitting.pixel_blocks import PixelBlocks
from brdfkit.fitting.problem import Problem
from brdfkit.geometry.directions import from_angles
from brdfkit.geometry.quadrature import ring_rule
from brdfkit.pictures import Pixels

# The factor between the albedos of a fit and its data beyond which the fit is searched once more;
# the search is kept where it brings the albedos nearer, the logarithm of their factor to this share
HELD, NEARER = 1.2, 0.6
# The factor beyond which the light of a fit is said to be wrong
WRONG = 1.25
# No surface reflects more; beyond rounding of the quadrature
ALL = 1.001
# How much the light counts beside the error, when both are as large as they were
SHARE = 10.0
# Half the rings of the quadrature, and the points on each
POINTS = 24
# Azimuths of incidence of an anisotropic material
AZIMUTHS = 4
UP = 0.0, 0.0, 1.0

DIFFERENCE = Loss(
    "light",
    "difference of albedos",
    lambda model, measured, cos_i, cos_o: model - measured,
    measure="samples",
)


@dataclass(frozen=True, eq=False)
class Light:
    """What a measurement reflects of light from some angles.

    `theta_i`: the angles [degrees] (n,); `values` (n, channels): the albedos; `known` (n,): whether
    the samples tell them; `pixels`: the quadrature that sums a model up to its own albedos.
    """

    theta_i: tuple[float, ...]
    values: NDArray[np.float64]
    known: NDArray[np.bool_]
    pixels: Pixels

    @classmethod
    def of(cls, albedo, anisotropic):
        """The light of a `MeasuredAlbedo`."""
        theta_i = albedo.theta_i
        azimuths = np.arange(AZIMUTHS) * 2 * np.pi / AZIMUTHS if anisotropic else np.zeros(1)
        rules = [
            [(wi, *ring_rule(wi, POINTS)) for wi in from_angles(np.radians(theta), azimuths)]
            for theta in theta_i
        ]
        pairs = max(sum(len(weight) for *_, weight in rule) for rule in rules)
        wi, wo = (np.tile(UP, (len(rules), pairs, 1)) for _ in range(2))
        shares = np.zeros((len(rules), pairs))
        for row, rule in enumerate(rules):
            incident = [np.broadcast_to(w, directions.shape) for w, directions, _ in rule]
            directions, weights = ([part[k] for part in rule] for k in (1, 2))
            count = sum(map(len, weights))
            wi[row, :count], wo[row, :count] = np.concatenate(incident), np.concatenate(directions)
            shares[row, :count] = np.concatenate(weights) / len(azimuths)
        flat = wi.reshape(-1, 3), wo.reshape(-1, 3), shares.ravel()
        values = np.minimum(albedo.values, 1)  # what a file may gain, no fit should
        pixels = Pixels(*flat, values, np.ones(len(theta_i)), pairs)
        return cls(theta_i, values, albedo.known, pixels)

    def factors(self, albedos):
        """The light of `albedos` (n, channels) over the measured one (n,), 1 where that is unknown."""
        mean, own = self.values.mean(axis=1), np.maximum(albedos.mean(axis=1), 1e-9)
        return np.where(self.known & (mean > 0), own / np.where(mean > 0, mean, 1), 1.0)

    def departure(self, albedos):
        """How far `albedos` (n, channels) are from the measured ones, as the logarithm of the
        largest factor, either way; light that is gained adds its own."""
        gain = max(float(np.log(albedos.max() / ALL)), 0.0) if albedos.max() > 0 else 0.0
        return float(np.abs(np.log(self.factors(albedos))).max()) + gain


class LightProblem(Problem):
    """E² of a model class on `Samples`, over that of a first search, and its difference in `Light`.

    `counted`: at which angles of the `light` (n,); `error`: E² of the first search.
    """

    def __init__(self, problem, light, counted, error):
        super().__init__(problem.model, problem.samples, problem.loss, problem.space)
        self.light, self.counted, self.first_error = light, counted, error
        known = counted
        mean = np.maximum(light.values.mean(axis=1, keepdims=True), 1e-6)
        pixels = light.pixels
        rows = np.repeat(known, pixels.pairs)
        pixels = Pixels(
            pixels.wi[rows],
            pixels.wo[rows],
            pixels.shares[rows],
            pixels.values[known],
            pixels.weights[known],
            pixels.pairs,
        )
        share = SHARE / (known.sum() * self.channels) / mean[known, 0] ** 2
        of_samples = self.importance / error
        self._of_samples = Blocks(self.samples, of_samples, self.loss)
        self._of_light = PixelBlocks(pixels, share, DIFFERENCE)
        self.importance = np.concatenate([of_samples, share])
        self.blocks = self._all_blocks

    def on(self, samples):
        """The same problem on other `Samples`."""
        part = Problem(self.model, samples, self.loss, self.space)
        return LightProblem(part, self.light, self.counted, self.first_error)

    def _all_blocks(self, count):
        yield from self._of_samples(count)
        yield from self._of_light(count)
