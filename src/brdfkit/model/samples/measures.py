"""Measures of direction pairs: how much of each measure a sample stands for.

A loss is an integral over all pairs of directions, which the samples of a file estimate. The
integral needs a measure, and two are natural for a BRDF. With the half and difference angles of
[Rusinkiewicz 1998] they are

    angles        dθ_h dθ_d dφ_d,             in which a highlight is large, and
    solid angle   dω_i dω_o = s dθ_h dθ_d dφ_d · 4 dφ_h,   s = sinθ_h sinθ_d cosθ_d,

in which it is small. The *extents* of a sample are the shares of both measures that it stands for.
``"balanced"`` is the geometric mean of the two measures, with the density √s in the angles.

The extents of scattered samples are estimated: points are spread over all pairs of directions, and
each point belongs to the nearest sample, if one is near. Formats and tables with a known grid state
their extents.
"""

from functools import cache

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_half_difference, to_half_difference
from brdfkit.model.samples.cells import minimum_cosine
from brdfkit.model.samples.coordinates import compute_coordinates, compute_sample_coordinates

# The density of a measure in the angles is this power of s; None gives each sample the weight 1
MEASURES: dict[str, float | None] = {
    "samples": None,
    "angles": 0.0,
    "balanced": 0.5,
    "solid_angle": 1.0,
}
# The farthest sample that a point belongs to, in the coordinates of `coordinates.py`: 3.6° in
# theta_h, or 0.5 in sin theta_d
REACH = 0.5
# Points for each sample, and their least and largest number in all
POINTS, FEWEST_POINTS, LARGEST_NUMBER = 16, 2**13, 2**18
# The least extent in the angles, as a share of the mean one
LEAST_EXTENT = 0.01
# Bins of theta_h, even in its square root; half of the points go to the bins of the samples
BINS = 90
# Cells along theta_h, theta_d and phi_d, which integrate the measures to 1e-3
GRID = 180, 90, 90


def compute_measure(extents: FloatArray | None, measure: str) -> FloatArray | float:
    """Return the measure of each sample by the name of the measure and the extents (n, 2).

    It is 1 if the extents are None, which means unknown.
    """
    power = MEASURES[measure]
    if power is None or extents is None:
        return 1.0
    angles, solid_angle = extents.T
    if power in (0.0, 1.0):
        return solid_angle if power else angles
    return angles ** (1 - power) * solid_angle**power


def density(theta_h: FloatArray, theta_d: FloatArray) -> FloatArray:
    """Return s = sinθ_h sinθ_d cosθ_d, the density of solid angle in the angles [rad]."""
    return np.sin(theta_h) * np.sin(theta_d) * np.cos(theta_d)


@cache
def integrate_measure(max_angle: float, measure: str) -> float:
    """Return the measure of all direction pairs with both angles below `max_angle` [degrees]."""
    steps = [(np.arange(n) + 0.5) / n for n in GRID]
    theta_h, theta_d, phi_d = np.meshgrid(*steps, indexing="ij")
    theta_h, theta_d, phi_d = theta_h * np.pi / 2, theta_d * np.pi / 2, phi_d * 2 * np.pi
    wi, wo = from_half_difference(theta_h, theta_d, phi_d)
    least = minimum_cosine(max_angle)
    inside = (wi[..., 2] > least) & (wo[..., 2] > least)
    cell = (np.pi / 2) ** 2 * 2 * np.pi / inside.size
    return float(cell * np.sum(density(theta_h, theta_d)[inside] ** (MEASURES[measure] or 0.0)))


def estimate_extents(
    wi: FloatArray, wo: FloatArray, anisotropic: bool, max_angle: float
) -> FloatArray:
    """Estimate the extents (n, 2) of scattered samples at direction pairs (n, 3).

    They are the shares of both measures that are nearest to each sample. All angles to the normal
    have to be below `max_angle` [degrees].
    """
    from scipy.spatial import cKDTree

    points_i, points_o, volumes = _spread_points(wi, wo, anisotropic, max_angle)
    places = compute_sample_coordinates(wi, wo, anisotropic)
    places, same = np.unique(places.round(6), axis=0, return_inverse=True)
    same = same.ravel()
    distance, nearest = cKDTree(places).query(compute_coordinates(points_i, points_o, anisotropic))
    near = distance <= REACH
    sums = np.stack(
        [np.bincount(nearest[near], volume[near], len(places)) for volume in volumes.T], axis=1
    )
    # Samples at one place share its extents
    shares = (sums / np.bincount(same)[:, None])[same]
    # A pair in both orders is one sample
    extents = shares.reshape(-1, len(wi), 2).sum(axis=0)
    # A sample that no point reached, since others are very near, gets a small extent
    missed = extents[:, 0] == 0
    theta_h, theta_d, _ = to_half_difference(wi[missed], wo[missed])
    extents[missed, 0] = LEAST_EXTENT * extents[:, 0].mean()
    extents[missed, 1] = extents[missed, 0] * density(theta_h, theta_d)
    return extents


def _spread_points(
    wi: FloatArray, wo: FloatArray, anisotropic: bool, max_angle: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Spread pairs of directions (m, 3) below `max_angle`, and return their volumes (m, 2), too.

    The pairs are even over the angles, but denser in θ_h where the samples are. The volumes are
    those by both measures.
    """
    from scipy.stats import qmc

    count = int(np.clip(POINTS * len(wi), FEWEST_POINTS, LARGEST_NUMBER))
    u = qmc.Sobol(4 if anisotropic else 3, rng=0).random_base2(int(np.ceil(np.log2(count))))
    edges = np.linspace(0, 1, BINS + 1) ** 2
    h = wi + wo
    theta = np.arctan2(np.hypot(h[:, 0], h[:, 1]), h[:, 2]) / (np.pi / 2)
    shares = np.histogram(theta, edges)[0] / len(wi)
    shares = 0.5 * np.diff(edges) + 0.5 * shares
    sums = np.concatenate([[0.0], np.cumsum(shares)])
    bins = np.clip(np.searchsorted(sums, u[:, 0], "right") - 1, 0, BINS - 1)
    inside = (u[:, 0] - sums[bins]) / shares[bins]
    theta_h = (edges[bins] + inside * np.diff(edges)[bins]) * np.pi / 2
    theta_d, phi_d = u[:, 1] * np.pi / 2, u[:, 2] * 2 * np.pi
    turn = (2 * np.pi * u[:, 3],) if anisotropic else ()
    pairs = from_half_difference(theta_h, theta_d, phi_d, *turn)
    least = minimum_cosine(max_angle)
    is_inside = (pairs[0][:, 2] > least) & (pairs[1][:, 2] > least)
    angles = (np.pi / 2) ** 2 * 2 * np.pi / len(u) * (np.diff(edges) / shares)[bins]
    volumes = np.stack([angles, angles * density(theta_h, theta_d)], axis=1)
    return pairs[0][is_inside], pairs[1][is_inside], volumes[is_inside]
