"""Compares values that should be equal, by reciprocity or by mirror symmetry."""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.geometry.directions import group_equal_pairs
from brdfkit.materials.auditing.subsets import (
    draw_row_numbers,
    draw_valid_samples,
    thin_out_theta_h,
)
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import map_pairs_to_points
from brdfkit.model.samples import Samples

SAME_ANGLE = np.radians(0.5)  # pairs of directions that differ by less count as equal


@dataclass(frozen=True)
class Difference:
    """Statistics of relative differences |a - b| / ½ (a + b) of values that should be equal.

    `pairs`: number of pairs of positive values a, b; `median`: median of the differences, NaN
    without any pair; `percentile_95`: bound on 95 % of the differences, NaN without any pair.
    """

    pairs: int
    median: float
    percentile_95: float

    def __bool__(self) -> bool:
        return self.pairs > 0


NOTHING = Difference(0, np.nan, np.nan)


def compare_reciprocal_values(data: Measured) -> Difference:
    """Return how far values f(wi, wo) and f(wo, wi) of a `Measured` differ, as a `Difference`."""
    if data.is_table:
        # Compare the two halves of the axis of phi_d, because exchanging wi and wo adds π to phi_d
        half, odd = divmod(data.table.shape[-1], 2)
        if data.table.phi_d_period == np.pi or odd:
            return NOTHING
        f = thin_out_theta_h(data.table)
        return compare_values(f[..., :half, :], f[..., half:, :])
    if data.has_lookup:
        return _compare_with_lookup(data, data.samples.wo, data.samples.wi)
    samples = draw_valid_samples(data)
    first, second = find_swapped_pairs(samples, data.anisotropic).T
    return compare_values(samples.values[first], samples.values[second])


def compare_mirrored_values(data: Measured) -> Difference:
    """Return how far values on both sides of the plane of incidence differ, as a `Difference`.

    They should be equal for an isotropic material. For an anisotropic one nothing is compared.
    """
    if data.anisotropic:
        return NOTHING
    if data.is_table:
        f = thin_out_theta_h(data.table)
        # Compare values at phi_d with values at -phi_d, across the plane of incidence
        half = f.shape[-2] // 2
        return compare_values(f[..., :half, :], f[..., : -half - 1 : -1, :])
    if data.has_lookup:
        mirrored = (w * [1, -1, 1] for w in (data.samples.wi, data.samples.wo))
        return _compare_with_lookup(data, *mirrored)
    samples = draw_valid_samples(data)
    first, second = find_mirrored_pairs(samples, data.anisotropic).T
    return compare_values(samples.values[first], samples.values[second])


def _compare_with_lookup(data: Measured, wi: FloatArray, wo: FloatArray) -> Difference:
    """Compare the samples with the interpolated BRDF at the directions `wi`, `wo` (n, 3).

    These directions are those of the samples, exchanged or mirrored.
    """
    rows = np.flatnonzero(data.samples.valid)
    rows = rows[draw_row_numbers(len(rows))]
    return compare_values(data.samples.values[rows], data.eval(wi[rows], wo[rows]))


def find_swapped_pairs(samples: Samples, anisotropic: bool) -> IntArray:
    """Find pairs of samples, as rows (n, 2), where one has the directions of the other exchanged.

    On an isotropic material, samples with θi = θo are left out, because exchanging their directions
    only mirrors them.
    """
    images = map_pairs_to_points(samples.wo, samples.wi, anisotropic)
    if not anisotropic:
        images[np.abs(images[:, 0] - images[:, 1]) < 2 * SAME_ANGLE] = np.inf
    return _pair_points_with_images(
        map_pairs_to_points(samples.wi, samples.wo, anisotropic), images
    )


def find_mirrored_pairs(samples: Samples, anisotropic: bool) -> IntArray:
    """Find pairs of samples, as rows (n, 2), that mirror each other at the plane of incidence.

    For an anisotropic material the result is empty.
    """
    if anisotropic:
        return np.empty((0, 2), int)
    points = map_pairs_to_points(samples.wi, samples.wo)
    return _pair_points_with_images(points, points * [1, 1, 1, -1])


def find_repeated_pairs(samples: Samples) -> IntArray:
    """Find pairs of samples, as rows (n, 2), with equal directions and values that differ.

    Of three samples, the first and the second are a pair, and the second and the third.
    """
    group, _ = group_equal_pairs(samples.wi, samples.wo)
    order = np.argsort(group, kind="stable")
    pairs = np.stack([order[:-1], order[1:]], axis=1)
    same = np.diff(group[order]) == 0
    copies = (samples.values[pairs[:, 0]] == samples.values[pairs[:, 1]]).all(axis=1)
    return pairs[same & ~copies]


def _pair_points_with_images(points: FloatArray, images: FloatArray) -> IntArray:
    """Find pairs (n, 2) of different rows of `points` where one is the image of the other.

    `images` are the images of the points by a symmetry; rows that are not finite are ignored. Each
    pair is returned once.
    """
    from scipy.spatial import cKDTree

    finite = np.flatnonzero(np.isfinite(images).all(axis=1))
    distance, nearest = cKDTree(points).query(images[finite], distance_upper_bound=SAME_ANGLE)
    near = np.isfinite(distance)
    rows = np.sort(np.stack([finite[near], nearest[near]], axis=1), axis=1)
    return np.unique(rows[rows[:, 0] != rows[:, 1]], axis=0)


def compute_relative_differences(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the differences (a - b) / ½ (a + b) of positive values, as a flat array."""
    both = (a > 0) & (b > 0)  # a comparison with NaN is False, so pairs with NaN are left out
    a, b = a[both], b[both]
    return 2 * (a - b) / (a + b)


def compare_values(a: FloatArray, b: FloatArray) -> Difference:
    """Return how far the values `a` and `b`, of the same shape, differ, as a `Difference`."""
    differences = np.abs(compute_relative_differences(a, b))
    if not differences.size:
        return NOTHING
    median, percentile = np.percentile(differences, (50, 95))
    return Difference(differences.size, float(median), float(percentile))
