"""Compares values that a symmetry makes equal: with exchanged directions, and left and right."""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.materials.auditing.subsets import draw_rows, draw_valid_samples, thin_half_vectors
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import map_pairs_to_points
from brdfkit.model.samples import Samples

SAME_ANGLE = np.radians(0.5)  # direction pairs that differ by less count as one


@dataclass(frozen=True)
class Difference:
    """Relative differences |a - b| / ½ (a + b) of positive values that should be equal.

    `pairs`: the number of pairs of values; `median` and `percentile_95`: of the differences, NaN
    without any pair.
    """

    pairs: int
    median: float
    percentile_95: float

    def __bool__(self) -> bool:
        return self.pairs > 0


NOTHING = Difference(0, np.nan, np.nan)


def compare_reciprocal(data: Measured) -> Difference:
    """Return the `Difference` of the values f(wi, wo) and f(wo, wi) of a `Measured`."""
    if data.is_table:
        # The exchange of wi and wo adds π to phi_d
        half, odd = divmod(data.table.shape[-1], 2)
        if data.table.phi_d_period == np.pi or odd:
            return NOTHING
        f = thin_half_vectors(data.table)
        return compare_values(f[..., :half, :], f[..., half:, :])
    if data.has_lookup:
        return _compare_with_lookup(data, data.samples.wo, data.samples.wi)
    samples = draw_valid_samples(data)
    first, second = find_swapped(samples, data.anisotropic).T
    return compare_values(samples.values[first], samples.values[second])


def compare_mirrored(data: Measured) -> Difference:
    """Return the `Difference` of values left and right of the plane of incidence.

    It should be 0 for an isotropic material. For an anisotropic one nothing is compared.
    """
    if data.anisotropic:
        return NOTHING
    if data.is_table:
        f = thin_half_vectors(data.table)
        half = f.shape[-2] // 2  # cells at phi_d against the cells at -phi_d
        return compare_values(f[..., :half, :], f[..., : -half - 1 : -1, :])
    if data.has_lookup:
        mirrored = (w * [1, -1, 1] for w in (data.samples.wi, data.samples.wo))
        return _compare_with_lookup(data, *mirrored)
    samples = draw_valid_samples(data)
    first, second = find_mirrored(samples, data.anisotropic).T
    return compare_values(samples.values[first], samples.values[second])


def _compare_with_lookup(data: Measured, wi: FloatArray, wo: FloatArray) -> Difference:
    """Return the `Difference` of the samples and the lookup at their images `wi`, `wo` (n, 3)."""
    rows = np.flatnonzero(data.samples.valid)
    rows = rows[draw_rows(len(rows))]
    return compare_values(data.samples.values[rows], data.eval(wi[rows], wo[rows]))


def find_swapped(samples: Samples, anisotropic: bool) -> IntArray:
    """Return pairs of rows (n, 2) of `Samples` where one has the other's directions exchanged.

    On an isotropic material, pairs with θi = θo are left out: their exchange is a mirror image.
    """
    images = map_pairs_to_points(samples.wo, samples.wi, anisotropic)
    if not anisotropic:
        images[np.abs(images[:, 0] - images[:, 1]) < 2 * SAME_ANGLE] = np.inf
    return _match(map_pairs_to_points(samples.wi, samples.wo, anisotropic), images)


def find_mirrored(samples: Samples, anisotropic: bool) -> IntArray:
    """Return pairs of rows (n, 2) of `Samples`, left and right of the plane of incidence.

    An anisotropic material has none.
    """
    if anisotropic:
        return np.empty((0, 2), int)
    points = map_pairs_to_points(samples.wi, samples.wo)
    return _match(points, points * [1, 1, 1, -1])


def _match(points: FloatArray, images: FloatArray) -> IntArray:
    """Return pairs (n, 2) of different rows of `points` where one is the other's image; each once.

    `images` are the images of the points by a symmetry; rows that are not finite have none.
    """
    from scipy.spatial import cKDTree

    finite = np.flatnonzero(np.isfinite(images).all(axis=1))
    distance, nearest = cKDTree(points).query(images[finite], distance_upper_bound=SAME_ANGLE)
    near = np.isfinite(distance)
    rows = np.sort(np.stack([finite[near], nearest[near]], axis=1), axis=1)
    return np.unique(rows[rows[:, 0] != rows[:, 1]], axis=0)


def compute_relative_differences(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return (a - b) / ½ (a + b) where both are positive, as a flat array."""
    both = (a > 0) & (b > 0)  # False where one is NaN
    a, b = a[both], b[both]
    return 2 * (a - b) / (a + b)


def compare_values(a: FloatArray, b: FloatArray) -> Difference:
    """Return the `Difference` of the values `a` and `b`, of one shape."""
    differences = np.abs(compute_relative_differences(a, b))
    if not differences.size:
        return NOTHING
    median, percentile = np.percentile(differences, (50, 95))
    return Difference(differences.size, float(median), float(percentile))
