"""From scattered measurements to a table: an isotropic, reciprocal BRDF between its samples.

Shepard's inverse-distance mean of the nearest samples, of the logarithm of the BRDF, so that
the result is positive and passes through the samples. The space is the half vector's angle and
the folded difference vector: reciprocity and the mirror symmetry of an isotropic surface put
the four equivalent pairs on one point. Beyond the samples the nearest ones continue unchanged.
A channel that is not positive counts as a thousandth of the median.

D. Shepard, "A two-dimensional interpolation function for irregularly-spaced data", ACM 1968.
"""

import numpy as np

from brdfkit.directions import to_half_difference
from brdfkit.table import Table

SHAPE = (90, 45, 90)
NEIGHBOURS = 12
# A highlight is narrow along theta_h and changes slowly with theta_d: one radian of theta_h
# counts as much as this many units of the difference vector.
THETA_H_SCALE = 8.0


def to_table(samples, shape=SHAPE):
    """The `Table` of shape (n_theta_h, n_theta_d, n_phi_d) of valid `samples`."""
    from scipy.spatial import cKDTree

    known = samples.valid & (samples.values > 0).any(axis=1)
    if not known.any():  # a black material
        known = samples.valid
    values = samples.values[known]
    floor = 1e-3 * np.median(values[values > 0]) if (values > 0).any() else 1e-12
    logarithms = np.log(np.maximum(values, floor))
    tree = cKDTree(_coordinates(samples.wi[known], samples.wo[known]))

    empty = Table(np.full((*shape, values.shape[1]), np.nan))
    wi, wo = empty.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    neighbours = min(NEIGHBOURS, len(values))
    points = _coordinates(wi[above], wo[above])
    distance, index = tree.query(points, k=np.arange(1, neighbours + 1))
    weight = 1 / np.maximum(distance, 1e-6) ** 3
    weight /= weight.sum(axis=1, keepdims=True)
    table = empty.values
    table[above] = np.exp(np.einsum("nk,nkc->nc", weight, logarithms[index]))
    return Table(table)


def _coordinates(wi, wo):
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    in_plane = np.abs(np.sin(theta_d) * np.cos(phi_d))
    across = np.abs(np.sin(theta_d) * np.sin(phi_d))
    return np.stack([THETA_H_SCALE * theta_h, in_plane, across], axis=-1)
