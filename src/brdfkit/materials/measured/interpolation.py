"""Interpolates scattered samples, and extrapolates them: a reciprocal BRDF that passes through all.

A guide, the `ggx` model that fits the samples best, is multiplied by the ratio of the samples to
the guide. This ratio is interpolated: an inverse-distance mean of its logarithm over the nearest
samples. So the result is positive, passes through the samples, and has the guide's highlight where
they are sparse. Beyond the measured angles it turns into the guide, which rises towards the horizon
as Fresnel's reflectance does.

Distances between samples of an isotropic material are those in θ_h, sin θ_d and
|cos θ_i - cos θ_o|: the four direction pairs that are equal by reciprocity and mirror symmetry are
one point there. For an anisotropic material they are those of the half vector and the difference
vector; each sample is entered twice, with its directions exchanged. A value that is not positive
counts as a thousandth of the median.

Inverse-distance weights are those of [Shepard 1968]; they end at the farthest neighbour as in
[Franke & Nielson 1980].
"""

import functools

import numpy as np

from brdfkit.core.geometry.directions import to_half_difference
from brdfkit.core.jit.threads import in_turn
from brdfkit.model import labels
from brdfkit.model.evaluation import lobe_values
from brdfkit.model.samples import Samples
from brdfkit.model.samples.coordinates import (
    HIGHLIGHT,
    RETROREFLECTION,
    anisotropic_coordinates,
    isotropic_coordinates,
)
from brdfkit.regression import losses, regress

NEIGHBOURS = 12
# The guide counts as much as a sample at this distance
REACH = 0.4
# The ratio fades to 1/e at this angle beyond the measured angles from the normal
FADING = np.radians(20)
# The model that is the guide; for fewer samples than this the guide is a constant
GUIDE, FEWEST = "ggx", 30
MAX_ANGLE = 90  # degrees: all samples but those at the horizon
# The highlight may reflect at least this share of the light at the horizon, however bright the
# diffuse term is
LEAST_LEFT = 0.05
# Samples with theta_d below the first and theta_h above the second angle tell retroreflection
BACK, APART = np.radians(5), np.radians(20)


class Interpolant:
    """The BRDF (wi, wo) → (n, channels) through the valid `samples`."""

    def __init__(self, samples, anisotropic=False):
        samples = samples.at(samples.valid)
        positive = samples.values[samples.values > 0]
        self.floor = 1e-3 * np.median(positive) if positive.size else 1e-12
        self.guide = _fit_guide(samples, anisotropic)
        wi, wo = samples.wi, samples.wo
        # The largest measured angle of the direction closer to the normal, and of the other one
        self.largest_angles = _sorted_angles(wi, wo).max(axis=0)
        ratios = self._logarithm(samples.values) - self._logarithm(self.guide(wi, wo))
        if anisotropic:
            self.coordinates = anisotropic_coordinates
            wi, wo = np.concatenate([wi, wo]), np.concatenate([wo, wi])
            ratios = np.concatenate([ratios, ratios])
        else:
            scales = _choose_scales(wi, wo, ratios)
            self.coordinates = functools.partial(isotropic_coordinates, scales=scales)
        self.log_ratio = _InverseDistanceMean(self.coordinates(wi, wo), ratios)

    def __call__(self, wi, wo):
        beyond = np.maximum(_sorted_angles(wi, wo) - self.largest_angles, 0) / FADING
        fading = np.exp(-(beyond**2).sum(axis=1, keepdims=True))
        ratio = fading * self.log_ratio(self.coordinates(wi, wo), REACH)
        return np.exp(ratio + self._logarithm(self.guide(wi, wo)))

    def _logarithm(self, values):
        return np.log(np.maximum(values, self.floor))


class _InverseDistanceMean:
    """The inverse-distance weighted mean of `values` (n, channels), which stand at `points` (n, d).

    Values at one and the same point are replaced by their mean.
    """

    def __init__(self, points, values):
        from scipy.spatial import cKDTree

        points, same = np.unique(np.round(points, 6), axis=0, return_inverse=True)
        counts = np.bincount(same.ravel())[:, None]
        self.values = np.zeros((len(points), values.shape[1]))
        np.add.at(self.values, same.ravel(), values)
        self.tree, self.values = cKDTree(points), self.values / counts

    def __call__(self, points, reach):
        """The mean (m, channels) at `points` (m, d) of the nearest values and of a value 0 at the
        distance `reach`."""
        # One neighbour more, at whose distance the weights reach 0, so that they are continuous; if
        # there is none, it is infinitely far
        distance, index = self.tree.query(points, k=np.arange(1, NEIGHBOURS + 2))
        closeness = 1 / np.maximum(distance, 1e-6)
        weight = (closeness - closeness[:, -1:]) ** 2
        weight[~weight.any(axis=1)] = 1.0  # all neighbours are equally far
        weight /= weight.sum(axis=1, keepdims=True)
        known = (closeness**3).sum(axis=1, keepdims=True)
        mean = np.einsum("nk,nkc->nc", weight, self.values[np.minimum(index, len(self.values) - 1)])
        return mean * known / (known + reach**-3)


def _choose_scales(wi, wo, ratios):
    """The factors of the isotropic coordinates, by whether the samples show retroreflection."""
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    back = (theta_d < BACK) & (theta_h > APART)
    # The guide has no retroreflection: it shows in the ratios
    retroreflective = back.any() and np.median(ratios[back]) > np.log(2)
    return RETROREFLECTION if retroreflective else HIGHLIGHT


def _sorted_angles(wi, wo):
    """The angles to the normal (n, 2) [rad] of each direction pair, the smaller one first."""
    cosines = np.sort(np.stack([wi[:, 2], wo[:, 2]], axis=1), axis=1)[:, ::-1]
    return np.arccos(np.clip(cosines, -1, 1))


@in_turn
def _fit_guide(samples, anisotropic):
    """The BRDF (wi, wo) → (n, channels) of the model that fits `samples` best, or a constant."""
    if len(samples.wi) < FEWEST or samples.values.max() <= 0:
        return functools.partial(_constant, np.median(samples.values, axis=0))
    # Fit the mean of the channels
    grey = samples.values.mean(axis=1, keepdims=True)
    grey = Samples.from_arrays(samples.wi, samples.wo, grey, None, ("Y",), "grey")
    model, how = labels.model(GUIDE), {"starts": 1, "anisotropic": anisotropic}
    inside = grey.at(grey.within(MAX_ANGLE))
    found = regress(model, inside, losses.named["log"], **how)
    (diffuse, specular), f0 = found.weights[0], found.shapes["f0"]
    too_bright = specular > _remaining(diffuse)
    if too_bright:
        # The samples do not show Fresnel's rise, and the fit overestimates it: fit again with an f0
        # that reflects no more than all light at the horizon
        f0 = min(f0 * specular / _remaining(diffuse), 1.0)
        found = regress(model, inside, losses.named["log"], **how, fixed={"f0": f0})
    # The weights of each channel, with the same shape parameters
    diffuse, specular = regress(
        model, samples, losses.named["log"], anisotropic=anisotropic, fixed=found.shapes
    ).weights.T
    rise = np.inf if too_bright else (1 - f0) * specular
    return _limit_rise(model, found.shapes, diffuse, f0 * specular, rise)


def _limit_rise(model, shapes, diffuse, constant, rise):
    """The guide with Schlick's Fresnel term as two terms, `constant` + `rise` (1 - cosθ_d)⁵.

    The arguments are weights (channels,). Each is limited so that no channel reflects more than all
    light at the horizon; an infinite rise becomes what is left to it there.
    """
    constant = np.minimum(constant, _remaining(diffuse))
    rise = np.minimum(rise, _remaining(diffuse) - constant)
    none = np.zeros_like(rise)
    terms = (
        (model(**shapes | {"f0": 1.0}), [diffuse, constant]),
        (model(**shapes | {"f0": 0.0}), [none, rise]),
    )
    return functools.partial(_sum, terms)


def _remaining(diffuse):
    """The share of light (channels,) that the diffuse term leaves to the highlight."""
    return np.maximum(1 - diffuse, LEAST_LEFT)


def _sum(terms, wi, wo):
    """The sum (n, channels) of models with the weights (lobes, channels): `terms` are the pairs."""
    return sum(lobe_values(model, wi, wo)[0] @ np.array(weights) for model, weights in terms)


def _constant(values, wi, wo):
    """The BRDF that has the same `values` (channels,) for all directions, (n, channels)."""
    return np.broadcast_to(values, (len(wi), len(values)))
