"""Interpolates and extrapolates scattered samples by a reciprocal BRDF that passes through them.

The `ggx` model that fits the samples best, the guide, is multiplied by the ratio of the samples to
the guide. This ratio is interpolated: an inverse-distance mean of its logarithm over the nearest
samples. So the result is positive, passes through the samples, and has the guide's highlight where
they are sparse. Beyond the measured angles it turns into the guide, which rises towards the horizon
as Fresnel's reflectance does.

For an isotropic material, distances between samples are measured in the half angle θ_h, the sine of
the difference angle, sin θ_d, and |cos θ_i - cos θ_o|: the four direction pairs that are equal by
reciprocity and mirror symmetry are one point there. For an anisotropic material they are measured
between half vectors and difference vectors, and each sample is entered twice, the second time with
its directions exchanged. A value that is not positive counts as a thousandth of the median.

[Shepard 1968] introduced inverse-distance weights; here they end at the farthest neighbour, as in
[Franke & Nielson 1980].
"""

import functools
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import to_half_difference
from brdfkit.core.jit.threads import in_turn
from brdfkit.materials.measured.measured_data import Lookup
from brdfkit.model import labels
from brdfkit.model.evaluation import compute_lobe_values
from brdfkit.model.samples import Samples
from brdfkit.model.samples.coordinates import (
    HIGHLIGHT,
    RETROREFLECTION,
    anisotropic_coordinates,
    isotropic_coordinates,
)
from brdfkit.regression import losses, regress

NEIGHBOURS = 12
GUIDE_DISTANCE = 0.4  # the guide counts as much as a sample at this distance
# The ratio fades to 1/e at this angle beyond the measured angles from the normal
FADING_ANGLE = np.radians(20)
# The model that is the guide; with fewer samples than this, the guide is a constant
GUIDE, FEWEST_SAMPLES = "ggx", 30
MAX_ANGLE = 90  # degrees: all samples except those at the horizon
# The highlight may reflect at least this share of the light at the horizon, however bright the
# diffuse term is
LEAST_HIGHLIGHT = 0.05
# Samples with theta_d below the first and theta_h above the second angle show retroreflection
RETRO_THETA_D, RETRO_THETA_H = np.radians(5), np.radians(20)


class Interpolant:
    """A function from direction pairs to BRDF values, which passes through the valid `samples`."""

    def __init__(self, samples: Samples, anisotropic: bool = False) -> None:
        samples = samples.at(samples.valid)
        positive = samples.values[samples.values > 0]
        self.floor = 1e-3 * np.median(positive) if positive.size else 1e-12
        self.guide = _fit_guide(samples, anisotropic)
        wi, wo = samples.wi, samples.wo
        # The largest measured angle of the direction closer to the normal, and of the other one
        self.largest_angles = _sort_angles(wi, wo).max(axis=0)
        ratios = self._take_logarithm(samples.values) - self._take_logarithm(self.guide(wi, wo))
        self.coordinates: Callable[[FloatArray, FloatArray], FloatArray]
        if anisotropic:
            self.coordinates = anisotropic_coordinates
            wi, wo = np.concatenate([wi, wo]), np.concatenate([wo, wi])
            ratios = np.concatenate([ratios, ratios])
        else:
            scales = _choose_scales(wi, wo, ratios)
            self.coordinates = functools.partial(isotropic_coordinates, scales=scales)
        self.log_ratio = _InverseDistanceMean(self.coordinates(wi, wo), ratios)

    def __call__(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        beyond = np.maximum(_sort_angles(wi, wo) - self.largest_angles, 0) / FADING_ANGLE
        fading = np.exp(-(beyond**2).sum(axis=1, keepdims=True))
        ratio = fading * self.log_ratio(self.coordinates(wi, wo), GUIDE_DISTANCE)
        return np.exp(ratio + self._take_logarithm(self.guide(wi, wo)))

    def _take_logarithm(self, values: FloatArray) -> FloatArray:
        return np.log(np.maximum(values, self.floor))


class _InverseDistanceMean:
    """The inverse-distance weighted mean of `values` (n, channels) at `points` (n, d).

    Values at one and the same point are replaced by their mean.
    """

    def __init__(self, points: FloatArray, values: FloatArray) -> None:
        from scipy.spatial import cKDTree

        points, same = np.unique(np.round(points, 6), axis=0, return_inverse=True)
        counts = np.bincount(same.ravel())[:, None]
        self.values = np.zeros((len(points), values.shape[1]))
        np.add.at(self.values, same.ravel(), values)
        self.tree, self.values = cKDTree(points), self.values / counts

    def __call__(self, points: FloatArray, distance_of_zero: float) -> FloatArray:
        """Return the mean (m, channels) of the values that are nearest to `points` (m, d).

        A value 0 at the distance `distance_of_zero` counts, too.
        """
        # One neighbour more, at whose distance the weights reach 0, so that they are continuous; if
        # there is none, it is infinitely far
        distance, index = self.tree.query(points, k=np.arange(1, NEIGHBOURS + 2))
        closeness = 1 / np.maximum(distance, 1e-6)
        weight = (closeness - closeness[:, -1:]) ** 2
        weight[~weight.any(axis=1)] = 1.0  # all neighbours are equally far
        weight /= weight.sum(axis=1, keepdims=True)
        known = (closeness**3).sum(axis=1, keepdims=True)
        mean = np.einsum("nk,nkc->nc", weight, self.values[np.minimum(index, len(self.values) - 1)])
        return mean * known / (known + distance_of_zero**-3)


def _choose_scales(
    wi: FloatArray, wo: FloatArray, ratios: FloatArray
) -> tuple[float, float, float]:
    """Return the factors of the isotropic coordinates: others where samples show retroreflection.

    `ratios` (n, channels): logarithms of the samples over the guide.
    """
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    back = (theta_d < RETRO_THETA_D) & (theta_h > RETRO_THETA_H)
    # The guide has no retroreflection, so the ratios show it
    retroreflective = back.any() and np.median(ratios[back]) > np.log(2)
    return RETROREFLECTION if retroreflective else HIGHLIGHT


def _sort_angles(wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Return the angles to the normal (n, 2) [rad] of direction pairs, the smaller one first."""
    cosines = np.sort(np.stack([wi[:, 2], wo[:, 2]], axis=1), axis=1)[:, ::-1]
    return np.arccos(np.clip(cosines, -1, 1))


@in_turn
def _fit_guide(samples: Samples, anisotropic: bool) -> Lookup:
    """Fit the guide to `samples`, as a function from directions to values; few give a constant."""
    if len(samples.wi) < FEWEST_SAMPLES or samples.values.max() <= 0:
        return functools.partial(_evaluate_constant, np.median(samples.values, axis=0))
    # Fit the mean of the channels
    grey = samples.values.mean(axis=1, keepdims=True)
    grey_samples = Samples.from_arrays(samples.wi, samples.wo, grey, None, ("Y",), "grey")
    inside = grey_samples.at(grey_samples.within(MAX_ANGLE))
    model: Any = labels.model(GUIDE)
    fit_guide = functools.partial(regress, model, loss=losses.named["log"], anisotropic=anisotropic)
    solution = fit_guide(inside, starts=1)
    (diffuse, specular), f0 = solution.weights[0], solution.shapes["f0"]
    too_bright = specular > _remaining(diffuse)
    if too_bright:
        # The samples do not show Fresnel's rise, and the fit overestimates it: fit again with an f0
        # that reflects no more than all light at the horizon
        f0 = min(f0 * specular / _remaining(diffuse), 1.0)
        solution = fit_guide(inside, starts=1, fixed={"f0": f0})
    # The weights of each channel, with the same shape parameters
    diffuse, specular = fit_guide(samples, fixed=solution.shapes).weights.T
    rise = np.inf if too_bright else (1 - f0) * specular
    return _limit_rise(model, solution.shapes, diffuse, f0 * specular, rise)


def _limit_rise(
    model: Any,
    shapes: dict[str, float],
    diffuse: FloatArray,
    constant: FloatArray,
    rise: FloatArray | float,
) -> Lookup:
    """Return the guide with Schlick's Fresnel term as two terms, constant + rise (1 - cosθ_d)⁵.

    The arguments are weights (channels,). Each is limited so that no channel reflects more than all
    light at the horizon; an infinite `rise` becomes the share that is left there.
    """
    constant = np.minimum(constant, _remaining(diffuse))
    rise = np.minimum(rise, _remaining(diffuse) - constant)
    none = np.zeros_like(rise)
    terms = (
        (model(**shapes | {"f0": 1.0}), [diffuse, constant]),
        (model(**shapes | {"f0": 0.0}), [none, rise]),
    )
    return functools.partial(_evaluate_sum, terms)


def _remaining(diffuse: FloatArray) -> FloatArray:
    """Return the share of light (channels,) that the diffuse term leaves to the highlight."""
    return np.maximum(1 - diffuse, LEAST_HIGHLIGHT)


def _evaluate_sum(
    terms: Iterable[tuple[Any, list[FloatArray]]], wi: FloatArray, wo: FloatArray
) -> FloatArray:
    """Return the sum (n, channels) of two models, the `terms`, with weights (lobes, channels)."""
    first, second = (
        compute_lobe_values(model, wi, wo)[0] @ np.array(weights) for model, weights in terms
    )
    return first + second


def _evaluate_constant(values: FloatArray, wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Return the same `values` (channels,) for all directions, as (n, channels)."""
    return np.broadcast_to(values, (len(wi), len(values)))
