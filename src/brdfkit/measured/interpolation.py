"""Between scattered samples, and beyond them: a reciprocal BRDF that passes through them all.

What is interpolated is the ratio of the samples to a guide, the `ggx` model that fits them best:
an inverse-distance mean of its logarithm over the nearest samples. So the result is positive,
passes through the samples, has the guide's highlight where they are sparse, and turns into the
guide beyond the measured angles, Fresnel's rise towards the horizon and all.

The space of an isotropic material is θ_h, sin θ_d and |cos θ_i - cos θ_o|: reciprocity and the
mirror symmetry put the four equivalent pairs on one point. That of an anisotropic one is the half
vector and the difference vector; each sample stands there twice, with its directions exchanged. A
channel that is not positive counts as a thousandth of the median.

Inverse-distance weights are those of [Shepard 1968]; they end at the farthest neighbour as in
[Franke & Nielson 1980].
"""

import functools

import numpy as np

from brdfkit.fitting import losses, regress
from brdfkit.fitting.problem import Problem
from brdfkit.geometry.directions import to_half_difference
from brdfkit.model import labels
from brdfkit.model.evaluation import lobe_values
from brdfkit.samples import Samples
from brdfkit.samples.coordinates import (
    HIGHLIGHT,
    RETROREFLECTION,
    anisotropic_coordinates,
    isotropic_coordinates,
)
from brdfkit.threads import in_turn

NEIGHBOURS = 12
# So far from the samples the guide counts as much as one of them
REACH = 0.4
# So far beyond the measured angles from the normal the ratio has faded to 1/e
FADING = np.radians(20)
# Fewer samples determine no guide
GUIDE, FEWEST = "ggx", 30
MAX_ANGLE = 90  # degrees: all samples but those at the horizon
# However white the diffuse term, a surface reflects this much more at the horizon
LEAST_LEFT = 0.05
# Retroreflection is looked for at theta_d below the one, theta_h above the other
BACK, APART = np.radians(5), np.radians(20)


class Scattered:
    """The BRDF (wi, wo) → (n, channels) through the valid `samples`."""

    def __init__(self, samples, anisotropic=False):
        samples = samples.at(samples.valid)
        positive = samples.values[samples.values > 0]
        self.floor = 1e-3 * np.median(positive) if positive.size else 1e-12
        self.guide = _guide(samples, anisotropic)
        wi, wo = samples.wi, samples.wo
        # the measured angle of the direction that is closer to the normal, and of the other
        self.measured = _angles(wi, wo).max(axis=0)
        ratios = self._logarithm(samples.values) - self._logarithm(self.guide(wi, wo))
        if anisotropic:
            self.coordinates = anisotropic_coordinates
            wi, wo = np.concatenate([wi, wo]), np.concatenate([wo, wi])
            ratios = np.concatenate([ratios, ratios])
        else:
            scales = _scales(wi, wo, ratios)
            self.coordinates = functools.partial(isotropic_coordinates, scales=scales)
        self.near = _Near(self.coordinates(wi, wo), ratios)

    def __call__(self, wi, wo):
        beyond = np.maximum(_angles(wi, wo) - self.measured, 0) / FADING
        left = np.exp(-(beyond**2).sum(axis=1, keepdims=True))
        ratio = left * self.near(self.coordinates(wi, wo), REACH)
        return np.exp(ratio + self._logarithm(self.guide(wi, wo)))

    def _logarithm(self, values):
        return np.log(np.maximum(values, self.floor))


class _Near:
    """The inverse-distance mean of `values` (n, channels) at `points` (n, d) nearby."""

    def __init__(self, points, values):
        from scipy.spatial import cKDTree

        points, same = np.unique(np.round(points, 6), axis=0, return_inverse=True)
        counts = np.bincount(same.ravel())[:, None]
        self.values = np.zeros((len(points), values.shape[1]))
        np.add.at(self.values, same.ravel(), values)
        self.tree, self.values = cKDTree(points), self.values / counts

    def __call__(self, points, reach):
        """(m, channels) at `points` (m, d); the value 0 counts as one sample at `reach`."""
        # One more, infinitely far if there is none, where the weights end: they do not jump
        distance, index = self.tree.query(points, k=np.arange(1, NEIGHBOURS + 2))
        closeness = 1 / np.maximum(distance, 1e-6)
        weight = (closeness - closeness[:, -1:]) ** 2
        weight[~weight.any(axis=1)] = 1.0  # all equally far
        weight /= weight.sum(axis=1, keepdims=True)
        known = (closeness**3).sum(axis=1, keepdims=True)
        mean = np.einsum("nk,nkc->nc", weight, self.values[np.minimum(index, len(self.values) - 1)])
        return mean * known / (known + reach**-3)


def _scales(wi, wo, ratios):
    """By what the isotropic coordinates of samples are multiplied."""
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    back = (theta_d < BACK) & (theta_h > APART)
    # no guide reflects back
    retroreflective = back.any() and np.median(ratios[back]) > np.log(2)
    return RETROREFLECTION if retroreflective else HIGHLIGHT


def _angles(wi, wo):
    """Angles to the normal (n, 2), the smaller one first."""
    cosines = np.sort(np.stack([wi[:, 2], wo[:, 2]], axis=1), axis=1)[:, ::-1]
    return np.arccos(np.clip(cosines, -1, 1))


@in_turn
def _guide(samples, anisotropic):
    """The BRDF (wi, wo) → (n, channels) of the model that fits `samples` best, or a constant."""
    if len(samples.wi) < FEWEST or samples.values.max() <= 0:
        return functools.partial(_constant, np.median(samples.values, axis=0))
    grey = samples.values.mean(axis=1, keepdims=True)
    grey = Samples.from_arrays(samples.wi, samples.wo, grey, None, ("Y",), "grey")
    model, how = labels.model(GUIDE), {"starts": 1, "anisotropic": anisotropic}
    inside = grey.at(grey.within(MAX_ANGLE))
    found = regress(model, inside, losses["log"], **how)
    (diffuse, specular), f0 = found.weights[0], found.shapes["f0"]
    too_bright = specular > _left(diffuse)
    if too_bright:
        # Fresnel's rise was not measured: no more than all light is reflected at the horizon
        f0 = min(f0 * specular / _left(diffuse), 1.0)
        found = regress(model, inside, losses["log"], **how, fixed={"f0": f0})
    shapes = model(**found.shapes).values
    diffuse, specular = (
        Problem(model, samples, losses["log"])
        .solve({name: shapes[name] for name in model.shapes(anisotropic=True)})
        .T
    )
    # Nor in any channel, whose highlights need not be equally bright: all of them rise to the rest
    steady = np.minimum(f0 * specular, _left(diffuse))
    rise = np.inf if too_bright else (1 - f0) * specular
    rise = np.minimum(rise, _left(diffuse) - steady)
    mirror, facets = model(**found.shapes | {"f0": 1.0}), model(**found.shapes | {"f0": 0.0})
    none = np.zeros_like(rise)
    return functools.partial(_sum, ((mirror, [diffuse, steady]), (facets, [none, rise])))


def _left(diffuse):
    """What the diffuse term leaves to the highlight."""
    return np.maximum(1 - diffuse, LEAST_LEFT)


def _sum(terms, wi, wo):
    """Σ lobes · weights, (n, channels), of models with weights (lobes, channels) each."""
    return sum(lobe_values(model, wi, wo)[0] @ np.array(weights) for model, weights in terms)


def _constant(values, wi, wo):
    return np.broadcast_to(values, (len(wi), len(values)))
