"""Measures on the space of direction pairs, which weight the samples in a loss.

A loss is an integral over all pairs of directions, estimated from the samples of a file. The
integral needs a measure. Two are natural for a BRDF, in the half and difference angles of
[Rusinkiewicz 1998]:

    angles        dθ_h dθ_d dφ_d                            highlights are a large part of it
    solid angle   dω_i dω_o = s dθ_h dθ_d dφ_d · 4 dφ_h     highlights are a small part of it

Here s = sinθ_h sinθ_d cosθ_d is the density of solid angle in the angles. A third measure,
``"balanced"``, is the geometric mean of the two, with the density √s. The *extents* of a sample are
two numbers, the amounts of angles and of solid angle that it represents.

Formats and tables with a known grid state the extents of their samples. For scattered samples they
are estimated: points are spread over all pairs of directions, and the amounts that a point
represents are added to the extents of the nearest sample, if one is near.
"""

from functools import cache

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_half_difference, to_half_difference
from brdfkit.core.quasi_random import draw_sobol_points
from brdfkit.model.samples.cells import minimum_cosine
from brdfkit.model.samples.coordinates import compute_coordinates, compute_sample_coordinates

# Names of the measures → the power of `solid_angle_density` that is their density over the angles;
# None: each sample counts 1
MEASURES: dict[str, float | None] = {
    "samples": None,
    "angles": 0.0,
    "balanced": 0.5,
    "solid_angle": 1.0,
}
# Largest distance from a point to the sample that represents it, in the coordinates of
# `coordinates.py`: 3.6° in theta_h, or 0.5 in sin theta_d
REACH = 0.5
# Number of points per sample that are spread over all direction pairs to estimate extents, and
# smallest and largest number of all points
POINTS, FEWEST_POINTS, LARGEST_NUMBER = 16, 2**13, 2**18
# If no point is nearest to a sample, because others are very near, its extent in the angles is set
# to this share of the mean extent, so that it still counts a little
LEAST_EXTENT = 0.01
# Number of bins of theta_h, equally wide in its square root, by which points are spread: half of
# the points evenly over theta_h, half of them as the samples are
BINS = 90
# Numbers of points along theta_h, theta_d and phi_d for integrals of a measure, which they make
# right to 1e-3
GRID = 180, 90, 90


def compute_measure(extents: FloatArray | None, measure: str) -> FloatArray | float:
    """Return the amount (n,) of a measure, given by name, that each sample represents.

    `extents` (n, 2) are the amounts of angles and of solid angle; if they are unknown (None), the
    result is 1.
    """
    power = MEASURES[measure]
    if power is None or extents is None:
        return 1.0
    angles, solid_angle = extents.T
    if power in (0.0, 1.0):
        return solid_angle if power else angles
    return angles ** (1 - power) * solid_angle**power


def solid_angle_density(theta_h: FloatArray, theta_d: FloatArray) -> FloatArray:
    """Return sinθ_h sinθ_d cosθ_d, the density of solid angle in the half and difference angles."""
    return np.sin(theta_h) * np.sin(theta_d) * np.cos(theta_d)


@cache
def integrate_measure(max_angle: float, measure: str) -> float:
    """Integrate a measure over all direction pairs within `max_angle` [degrees] of the normal."""
    theta_h, theta_d, phi_d = ((np.arange(n) + 0.5) / n for n in GRID)
    theta_h, theta_d, phi_d = theta_h[:, None] * np.pi / 2, theta_d * np.pi / 2, phi_d * 2 * np.pi
    # The cosines of both angles to the normal, cosθ_h cosθ_d ± sinθ_h sinθ_d cosφ_d, exceed the
    # least one where |cosφ_d| is below a limit; count these φ_d
    above = np.cos(theta_h) * np.cos(theta_d) - minimum_cosine(max_angle)
    limit = above / (np.sin(theta_h) * np.sin(theta_d))
    counts = np.searchsorted(np.sort(np.abs(np.cos(phi_d))), limit)
    cell = (np.pi / 2) ** 2 * 2 * np.pi / np.prod(GRID)
    density = solid_angle_density(theta_h, theta_d) ** (MEASURES[measure] or 0.0)
    return float(cell * np.sum(counts * density))


def estimate_extents(
    wi: FloatArray, wo: FloatArray, anisotropic: bool, max_angle: float
) -> FloatArray:
    """Estimate the extents (n, 2) of scattered samples: the amounts of angles and solid angle.

    A sample represents the direction pairs to which it is the nearest. `wi` and `wo` (n, 3) have to
    be within `max_angle` [degrees] of the normal.
    """
    from scipy.spatial import cKDTree

    points_i, points_o, volumes = _spread_points(wi, wo, anisotropic, max_angle)
    points = compute_sample_coordinates(wi, wo, anisotropic)
    points, same = np.unique(points.round(6), axis=0, return_inverse=True)
    same = same.ravel()
    distance, nearest = cKDTree(points).query(compute_coordinates(points_i, points_o, anisotropic))
    near = distance <= REACH
    sums = np.stack(
        [np.bincount(nearest[near], volume[near], len(points)) for volume in volumes.T], axis=1
    )
    # Samples at the same point share its extents equally
    shares = (sums / np.bincount(same)[:, None])[same]
    # Each sample of an anisotropic material has two points, one for each order of wi and wo
    extents = shares.reshape(-1, len(wi), 2).sum(axis=0)
    # Samples that are nearest to no point, since others are very near, get small extents
    missed = extents[:, 0] == 0
    theta_h, theta_d, _ = to_half_difference(wi[missed], wo[missed])
    extents[missed, 0] = LEAST_EXTENT * extents[:, 0].mean()
    extents[missed, 1] = extents[missed, 0] * solid_angle_density(theta_h, theta_d)
    return extents


def _spread_points(
    wi: FloatArray, wo: FloatArray, anisotropic: bool, max_angle: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Spread points over all direction pairs within `max_angle`, denser in θ_h near samples.

    Returns their directions (m, 3) and (m, 3), and the amounts (m, 2) of angles and solid angle
    that each point represents. The points are quasi-random (Sobol).
    """
    count = int(np.clip(POINTS * len(wi), FEWEST_POINTS, LARGEST_NUMBER))
    u = draw_sobol_points(int(np.ceil(np.log2(count))), 4 if anisotropic else 3, seed=0)
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
    volumes = np.stack([angles, angles * solid_angle_density(theta_h, theta_d)], axis=1)
    return pairs[0][is_inside], pairs[1][is_inside], volumes[is_inside]
