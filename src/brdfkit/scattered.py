"""Between scattered samples, and beyond them: a reciprocal BRDF that passes through them all.

What is interpolated is the ratio of the samples to a guide, the `ggx` model that fits them best, by
Shepard's inverse-distance mean of its logarithm over the nearest samples. So the result is
positive, passes through the samples, has the guide's highlight where they are sparse, and turns
into the guide beyond them, Fresnel's rise at grazing angles and all.

The space of an isotropic material is θ_h, sin θ_d and |cos θ_i - cos θ_o|: reciprocity and the
mirror symmetry put the four equivalent pairs on one point. That of an anisotropic one is the half
vector and the difference vector; each sample stands there twice, with its directions exchanged. A
channel that is not positive counts as a thousandth of the median.

D. Shepard, "A two-dimensional interpolation function for irregularly-spaced data", ACM 1968.
"""

import functools

import numpy as np

from brdfkit.directions import half_azimuth, to_half_difference

NEIGHBOURS = 12
# So far from the samples the guide counts as much as one of them
REACH = 0.3
# Fewer samples determine no guide
GUIDE, FEWEST = "ggx", 30
# However white the diffuse term, a surface reflects this much more at the horizon
LEAST_LEFT = 0.05
# A highlight is narrow along theta_h and changes slowly with theta_d: one radian of theta_h
# counts as much as this many units of the difference vector.
THETA_H_SCALE = 8.0


class Scattered:
    """The BRDF (wi, wo) → (n, channels) through the valid `samples`."""

    def __init__(self, samples, anisotropic=False):
        from scipy.spatial import cKDTree

        samples = samples.at(samples.valid)
        positive = samples.values[samples.values > 0]
        self.floor = 1e-3 * np.median(positive) if positive.size else 1e-12
        self.guide = _guide(samples, anisotropic)
        self.coordinates = anisotropic_coordinates if anisotropic else isotropic_coordinates
        wi, wo = samples.wi, samples.wo
        ratios = self._logarithm(samples.values) - self._logarithm(self.guide(wi, wo))
        if anisotropic:
            wi, wo = np.concatenate([wi, wo]), np.concatenate([wo, wi])
            ratios = np.concatenate([ratios, ratios])
        self.tree, self.ratios = cKDTree(self.coordinates(wi, wo)), ratios

    def __call__(self, wi, wo):
        neighbours = np.arange(1, min(NEIGHBOURS, len(self.ratios)) + 1)
        distance, index = self.tree.query(self.coordinates(wi, wo), k=neighbours)
        weight = 1 / np.maximum(distance, 1e-6) ** 3
        weight /= weight.sum(axis=1, keepdims=True) + REACH**-3
        ratio = np.einsum("nk,nkc->nc", weight, self.ratios[index])
        return np.exp(ratio + self._logarithm(self.guide(wi, wo)))

    def _logarithm(self, values):
        return np.log(np.maximum(values, self.floor))


def _guide(samples, anisotropic):
    """The BRDF (wi, wo) → (n, channels) of the model that fits `samples` best, or a constant."""
    from brdfkit.fitting import fit
    from brdfkit.fitting.loss import losses
    from brdfkit.fitting.problem import Problem
    from brdfkit.measured import Measured

    if len(samples.wi) < FEWEST or samples.values.max() <= 0:
        return functools.partial(_constant, np.median(samples.values, axis=0))
    grey = samples.values.mean(axis=1, keepdims=True)
    grey = Measured.from_samples(samples.wi, samples.wo, grey, channels=("Y",))
    options = {"starts": 1, "anisotropic": anisotropic, "max_angle": 90}
    found = fit(GUIDE, grey, "log", **options).model
    specular, left = found.specular_reflectance[0], 1 - found.diffuse_reflectance[0]
    if specular > max(left, LEAST_LEFT):
        # Fresnel's rise was not measured: no more than all light is reflected at the horizon
        f0 = found.f0 * specular / max(left, LEAST_LEFT)
        found = fit(GUIDE, grey, "log", **options, fixed={"f0": min(f0, 1.0)}).model
    shapes = {name: getattr(found, name) for name in found.shapes(anisotropic=True)}
    weights = Problem(type(found), samples, losses["log"]).solve(shapes)
    return type(found)(**shapes, **dict(zip(found.weights(), weights.T, strict=True))).eval


def _constant(values, wi, wo):
    return np.broadcast_to(values, (len(wi), len(values)))


def isotropic_coordinates(wi, wo):
    """Points (n, 3): the closer, the more alike is an isotropic BRDF."""
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    # That is 2 sinθ_h sinθ_d |cos φ_d|: at the mirror direction phi_d means nothing
    apart = np.abs(wi[:, 2] - wo[:, 2])
    return np.stack([THETA_H_SCALE * theta_h, np.sin(theta_d), apart], axis=-1)


def anisotropic_coordinates(wi, wo):
    """Points (n, 4): the closer, the more alike is any BRDF."""
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    phi_h = half_azimuth(wi, wo)
    radius = THETA_H_SCALE * theta_h
    # The difference vector in the surface's frame: phi_d alone turns with phi_h at the normal
    azimuth = phi_d + phi_h
    return np.stack(
        [
            radius * np.cos(phi_h),
            radius * np.sin(phi_h),
            np.sin(theta_d) * np.cos(azimuth),
            np.sin(theta_d) * np.sin(azimuth),
        ],
        axis=-1,
    )
