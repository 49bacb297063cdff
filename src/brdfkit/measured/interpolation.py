"""Between scattered samples, and beyond them: a reciprocal BRDF that passes through them all.

What is interpolated is the ratio of the samples to a guide, the `ggx` model that fits them best:
an inverse-distance mean of its logarithm over the nearest samples. So the result is positive,
passes through the samples, has the guide's highlight where they are sparse, and turns into the
guide beyond the measured angles, Fresnel's rise towards the horizon and all.

The space of an isotropic material is θ_h, sin θ_d and |cos θ_i - cos θ_o|: reciprocity and the
mirror symmetry put the four equivalent pairs on one point. That of an anisotropic one is the half
vector and the difference vector; each sample stands there twice, with its directions exchanged. A
channel that is not positive counts as a thousandth of the median.

D. Shepard, "A two-dimensional interpolation function for irregularly-spaced data", ACM 1968; the
weights end at the farthest neighbour as in R. Franke & G. Nielson, "Smooth interpolation of large
sets of scattered data", IJNME 15, 1980.
"""

import functools

import numpy as np

from brdfkit.geometry.directions import half_azimuth, to_half_difference

NEIGHBOURS = 12
# So far from the samples the guide counts as much as one of them
REACH = 0.4
# So far beyond the measured angles from the normal the ratio has faded to 1/e
FADING = np.radians(20)
# Fewer samples determine no guide
GUIDE, FEWEST = "ggx", 30
# However white the diffuse term, a surface reflects this much more at the horizon
LEAST_LEFT = 0.05
# What a unit of theta_h, sinθ_d and the third coordinate counts. A highlight is narrow along
# theta_h and changes slowly with theta_d; retroreflection, at theta_d = 0, is narrow along both.
HIGHLIGHT, RETROREFLECTION = (8.0, 1.0, 1.0), (4.0, 4.0, 4.0)
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


def _guide(samples, anisotropic):
    """The BRDF (wi, wo) → (n, channels) of the model that fits `samples` best, or a constant."""
    from brdfkit.fitting import fit
    from brdfkit.fitting.loss import losses
    from brdfkit.fitting.problem import Problem
    from brdfkit.measured.measured import Measured

    if len(samples.wi) < FEWEST or samples.values.max() <= 0:
        return functools.partial(_constant, np.median(samples.values, axis=0))
    grey = samples.values.mean(axis=1, keepdims=True)
    grey = Measured.from_samples(samples.wi, samples.wo, grey, channels=("Y",))

    options = {"starts": 1, "anisotropic": anisotropic, "max_angle": 90}
    found = fit(GUIDE, grey, "log", **options).model
    specular, left = found.specular_reflectance[0], _left(found.diffuse_reflectance[0])
    too_bright = specular > left
    if too_bright:
        # Fresnel's rise was not measured: no more than all light is reflected at the horizon
        f0 = min(found.f0 * specular / left, 1.0)
        found = fit(GUIDE, grey, "log", **options, fixed={"f0": f0}).model
    shapes = {name: getattr(found, name) for name in found.shapes(anisotropic=True)}
    diffuse, specular = Problem(type(found), samples, losses["log"]).solve(shapes).T
    # Nor in any channel, whose highlights need not be equally bright: all of them rise to the rest
    steady = np.minimum(found.f0 * specular, _left(diffuse))
    rise = np.inf if too_bright else (1 - found.f0) * specular
    rise = np.minimum(rise, _left(diffuse) - steady)
    guides = [
        type(found)(
            **shapes | {"f0": 1.0}, diffuse_reflectance=diffuse, specular_reflectance=steady
        ),
        type(found)(**shapes | {"f0": 0.0}, diffuse_reflectance=0.0, specular_reflectance=rise),
    ]
    return functools.partial(_sum, guides)


def _left(diffuse):
    """What the diffuse term leaves to the highlight."""
    return np.maximum(1 - diffuse, LEAST_LEFT)


def _sum(brdfs, wi, wo):
    return sum(brdf.eval(wi, wo) for brdf in brdfs)


def _constant(values, wi, wo):
    return np.broadcast_to(values, (len(wi), len(values)))


def isotropic_coordinates(wi, wo, scales=HIGHLIGHT):
    """Points (n, 3): the closer, the more alike is an isotropic BRDF."""
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    # That is 2 sinθ_h sinθ_d |cos φ_d|: at the mirror direction phi_d means nothing
    apart = np.abs(wi[:, 2] - wo[:, 2])
    return np.stack([theta_h, np.sin(theta_d), apart], axis=-1) * scales


def anisotropic_coordinates(wi, wo):
    """Points (n, 4): the closer, the more alike is any BRDF."""
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    phi_h = half_azimuth(wi, wo)
    radius = HIGHLIGHT[0] * theta_h
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
