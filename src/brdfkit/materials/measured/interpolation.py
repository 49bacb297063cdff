"""Interpolates and extrapolates scattered samples by a reciprocal BRDF that passes through them.

First the model `ggx` is fitted to the samples: the guide. Then the ratio of the samples to the
guide is interpolated, by an inverse-distance mean of its logarithm over the nearest samples. The
result is the guide times this ratio. It is positive, passes through the samples, and has the
guide's highlight where samples are sparse. Beyond the measured angles it turns into the guide,
which rises towards the horizon as Fresnel's reflectance does.

The coordinates in which distances are measured respect the symmetries. For an isotropic material
they are the half angle θ_h, the sine of the difference angle θ_d, and |cos θ_i - cos θ_o|. For an
anisotropic material they are the half vector and the difference vector, and each sample is entered
a second time with its directions exchanged. A value that is not positive is replaced by a
thousandth of the median.

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
    to_anisotropic_points,
    to_isotropic_points,
)
from brdfkit.regression import losses, regress

NEIGHBOURS = 12  # number of nearest samples that are averaged
GUIDE_DISTANCE = 0.4  # distance of a sample that weighs as much in the mean as the fitted guide
# The logarithm of the ratio of samples to guide fades to 1/e at this angle beyond the measured ones
FADING_ANGLE = np.radians(20)
# The model of the guide, which is fitted to the samples. With fewer than FEWEST_SAMPLES, the guide
# is a constant
GUIDE, FEWEST_SAMPLES = "ggx", 30
MAX_ANGLE = 90  # degrees; the guide is fitted to samples with smaller angles to the normal
# Share of the light that the highlight may reflect at the horizon even where a bright diffuse term
# leaves less
LEAST_HIGHLIGHT = 0.05
# Samples with theta_d below the first angle and theta_h above the second show whether the material
# is retroreflective
RETRO_THETA_D, RETRO_THETA_H = np.radians(5), np.radians(20)


class Interpolant:
    """A BRDF function, called with directions (n, 3), that interpolates the valid `samples`."""

    def __init__(self, samples: Samples, anisotropic: bool = False) -> None:
        samples = samples.at(samples.valid)
        positive = samples.values[samples.values > 0]
        self.floor = 1e-3 * np.median(positive) if positive.size else 1e-12
        self.guide = _fit_guide(samples, anisotropic)
        wi, wo = samples.wi, samples.wo
        # A sample's two directions have a smaller and a larger angle to the normal. Find the
        # maximum of the smaller angles over all samples, and that of the larger ones
        self.largest_angles = _sort_angles(wi, wo).max(axis=0)
        ratios = self._take_bounded_logarithm(samples.values) - self._take_bounded_logarithm(
            self.guide(wi, wo)
        )
        self.coordinates: Callable[[FloatArray, FloatArray], FloatArray]
        if anisotropic:
            self.coordinates = to_anisotropic_points
            wi, wo = np.concatenate([wi, wo]), np.concatenate([wo, wi])
            ratios = np.concatenate([ratios, ratios])
        else:
            scales = _choose_coordinate_scales(wi, wo, ratios)
            self.coordinates = functools.partial(to_isotropic_points, scales=scales)
        self.log_ratio = _InverseDistanceMean(self.coordinates(wi, wo), ratios)

    def __call__(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        beyond = np.maximum(_sort_angles(wi, wo) - self.largest_angles, 0) / FADING_ANGLE
        fading = np.exp(-(beyond**2).sum(axis=1, keepdims=True))
        ratio = fading * self.log_ratio(self.coordinates(wi, wo), GUIDE_DISTANCE)
        return np.exp(ratio + self._take_bounded_logarithm(self.guide(wi, wo)))

    def _take_bounded_logarithm(self, values: FloatArray) -> FloatArray:
        return np.log(np.maximum(values, self.floor))


class _InverseDistanceMean:
    """A function that interpolates `values` (n, channels), given at `points` (n, d).

    It is an inverse-distance weighted mean of the nearest values. Values at the same point are
    averaged first.
    """

    def __init__(self, points: FloatArray, values: FloatArray) -> None:
        from scipy.spatial import cKDTree

        points, same = np.unique(np.round(points, 6), axis=0, return_inverse=True)
        counts = np.bincount(same.ravel())[:, None]
        self.values = np.zeros((len(points), values.shape[1]))
        np.add.at(self.values, same.ravel(), values)
        self.tree, self.values = cKDTree(points), self.values / counts

    def __call__(self, points: FloatArray, distance_of_zero: float) -> FloatArray:
        """Return the weighted mean (m, channels) of the values nearest to each of `points` (m, d).

        A further value, 0 at the distance `distance_of_zero`, enters the mean.
        """
        # Find one neighbour more than are averaged. The weights reach 0 at its distance, so that
        # the mean is continuous. If there are too few points, it is infinitely far away
        distance, index = self.tree.query(points, np.arange(1, NEIGHBOURS + 2), workers=-1)
        closeness = 1 / np.maximum(distance, 1e-6)
        weight = (closeness - closeness[:, -1:]) ** 2
        weight[~weight.any(axis=1)] = 1.0  # where all neighbours are equally far, weight them alike
        weight /= weight.sum(axis=1, keepdims=True)
        known = (closeness**3).sum(axis=1, keepdims=True)
        mean = np.einsum("nk,nkc->nc", weight, self.values[np.minimum(index, len(self.values) - 1)])
        return mean * known / (known + distance_of_zero**-3)


def _choose_coordinate_scales(
    wi: FloatArray, wo: FloatArray, ratios: FloatArray
) -> tuple[float, float, float]:
    """Return the scale factors of the isotropic coordinates in which distances are measured.

    They differ for retroreflective samples. `ratios` (n, channels) are the logarithms of the
    samples over the guide, the model that was fitted to them.
    """
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    back = (theta_d < RETRO_THETA_D) & (theta_h > RETRO_THETA_H)
    # The guide has no retroreflection, so ratios of samples to guide above 2 reveal it
    retroreflective = back.any() and np.median(ratios[back]) > np.log(2)
    return RETROREFLECTION if retroreflective else HIGHLIGHT


def _sort_angles(wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Return the angles to the normal (n, 2) [rad] of pairs of directions, the smaller first."""
    cosines = np.sort(np.stack([wi[:, 2], wo[:, 2]], axis=1), axis=1)[:, ::-1]
    return np.arccos(np.clip(cosines, -1, 1))


@in_turn
def _fit_guide(samples: Samples, anisotropic: bool) -> Lookup:
    """Fit the guide, the model that is multiplied by the interpolated ratio, to `samples`.

    The result is a BRDF function; it is constant where there are few samples.
    """
    if len(samples.wi) < FEWEST_SAMPLES or samples.values.max() <= 0:
        return functools.partial(_evaluate_constant_brdf, np.median(samples.values, axis=0))
    # Find the guide's shape parameters by a fit to the mean of the channels
    grey = samples.values.mean(axis=1, keepdims=True)
    grey_samples = Samples.from_arrays(samples.wi, samples.wo, grey, None, ("Y",), "grey")
    inside = grey_samples.at(grey_samples.within(MAX_ANGLE))
    model: Any = labels.model(GUIDE)
    fit_guide = functools.partial(regress, model, loss=losses.named["log"], anisotropic=anisotropic)
    solution = fit_guide(inside, starts=1)
    (diffuse, specular), f0 = solution.weights[0], solution.shapes["f0"]
    too_bright = specular > _compute_share_left_by_diffuse(diffuse)
    if too_bright:
        # The samples do not show how the Fresnel term rises towards grazing angles, and the fit
        # overestimates it. Fit again with a fixed reflectance at normal incidence, f0, with which
        # at most all light is reflected at grazing angles
        f0 = min(f0 * specular / _compute_share_left_by_diffuse(diffuse), 1.0)
        solution = fit_guide(inside, starts=1, fixed={"f0": f0})
    # Find the weights of diffuse term and highlight by a fit to each channel, with these shapes
    diffuse, specular = fit_guide(samples, fixed=solution.shapes).weights.T
    rise = np.inf if too_bright else (1 - f0) * specular
    return _limit_fresnel_rise(model, solution.shapes, diffuse, f0 * specular, rise)


def _limit_fresnel_rise(
    model: Any,
    shapes: dict[str, float],
    diffuse: FloatArray,
    constant: FloatArray,
    rise: FloatArray | float,
) -> Lookup:
    """Return the guide, limited so that no channel reflects more light at the horizon than arrives.

    `model` and `shapes` are the guide's model and shape parameters. The highlight's Fresnel term is
    Schlick's, constant + rise (1 - cosθ_d)⁵. `diffuse`, `constant` and `rise` are weights
    (channels,). An infinite `rise` becomes the share of the light that the other two leave.
    """
    constant = np.minimum(constant, _compute_share_left_by_diffuse(diffuse))
    rise = np.minimum(rise, _compute_share_left_by_diffuse(diffuse) - constant)
    none = np.zeros_like(rise)
    terms = (
        (model(**shapes | {"f0": 1.0}), [diffuse, constant]),
        (model(**shapes | {"f0": 0.0}), [none, rise]),
    )
    return functools.partial(_evaluate_model_sum, terms)


def _compute_share_left_by_diffuse(diffuse: FloatArray) -> FloatArray:
    """Return the share of the light (channels,) that the diffuse term leaves to the highlight."""
    return np.maximum(1 - diffuse, LEAST_HIGHLIGHT)


def _evaluate_model_sum(
    terms: Iterable[tuple[Any, list[FloatArray]]], wi: FloatArray, wo: FloatArray
) -> FloatArray:
    """Return the sum (n, channels) of two models' BRDFs for directions (n, 3).

    `terms` has each model with the weights (lobes, channels) of its lobes, the diffuse one first.
    """
    first, second = (
        compute_lobe_values(model, wi, wo)[0] @ np.array(weights) for model, weights in terms
    )
    return first + second


def _evaluate_constant_brdf(values: FloatArray, wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Return a constant BRDF: the same `values` (channels,) for all n pairs, as (n, channels)."""
    return np.broadcast_to(values, (len(wi), len(values)))
