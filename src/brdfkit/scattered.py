"""From scattered measurements to a table: a reciprocal BRDF between its samples.

Shepard's inverse-distance mean of the nearest samples, of the logarithm of the BRDF, so that
the result is positive and passes through the samples. The space of an isotropic material is the
half vector's angle and the folded difference vector: reciprocity and the mirror symmetry put the
four equivalent pairs on one point. That of an anisotropic one is the half vector and the
difference vector; each sample stands there twice, with its directions exchanged. Beyond the
samples the nearest ones continue unchanged. A channel that is not positive counts as a thousandth
of the median.

D. Shepard, "A two-dimensional interpolation function for irregularly-spaced data", ACM 1968.
"""

import numpy as np

from brdfkit.directions import half_azimuth, to_half_difference
from brdfkit.table import Table

SHAPE = (90, 45, 90)
ANISOTROPIC_SHAPE = (36, 45, 23, 36)
NEIGHBOURS = 12
# A highlight is narrow along theta_h and changes slowly with theta_d: one radian of theta_h
# counts as much as this many units of the difference vector.
THETA_H_SCALE = 8.0


def to_table(samples, anisotropic=False):
    """The `Table` of valid `samples`."""
    from scipy.spatial import cKDTree

    known = samples.valid & (samples.values > 0).any(axis=1)
    if not known.any():  # a black material
        known = samples.valid
    wi, wo, values = samples.wi[known], samples.wo[known], samples.values[known]
    floor = 1e-3 * np.median(values[values > 0]) if (values > 0).any() else 1e-12
    logarithms = np.log(np.maximum(values, floor))
    coordinates = _isotropic
    if anisotropic:
        coordinates = anisotropic_coordinates
        wi, wo = np.concatenate([wi, wo]), np.concatenate([wo, wi])
        logarithms = np.concatenate([logarithms, logarithms])
    tree = cKDTree(coordinates(wi, wo))
    neighbours = min(NEIGHBOURS, len(logarithms))

    def interpolated(wi, wo):
        distance, index = tree.query(coordinates(wi, wo), k=np.arange(1, neighbours + 1))
        weight = 1 / np.maximum(distance, 1e-6) ** 3
        weight /= weight.sum(axis=1, keepdims=True)
        return np.exp(np.einsum("nk,nkc->nc", weight, logarithms[index]))

    return sampled(interpolated, values.shape[1], anisotropic)


def sampled(lookup, channels, anisotropic=False):
    """The `Table` of `lookup(wi, wo)` at its cells' centres, NaN below the surface."""
    shape = ANISOTROPIC_SHAPE if anisotropic else SHAPE
    table = Table(np.full((*shape, channels), np.nan))
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    table.values[above] = lookup(wi[above], wo[above])
    return table


def _isotropic(wi, wo):
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    in_plane = np.abs(np.sin(theta_d) * np.cos(phi_d))
    across = np.abs(np.sin(theta_d) * np.sin(phi_d))
    return np.stack([THETA_H_SCALE * theta_h, in_plane, across], axis=-1)


def anisotropic_coordinates(wi, wo):
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
