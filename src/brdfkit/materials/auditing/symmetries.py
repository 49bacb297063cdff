"""Pairs of samples whose values a symmetry makes equal, and how far these values differ."""

from dataclasses import dataclass

import numpy as np

from brdfkit.materials.auditing.spread import some_half_vectors, some_rows, some_valid
from brdfkit.materials.measured.coverage import to_points

SAME = np.radians(0.5)  # pairs this near are taken for one


@dataclass(frozen=True)
class Difference:
    """Relative differences |a - b| / ½ (a + b) of positive values that should be equal.

    `pairs`: the number of pairs of values; their `median` and `percentile_95`: NaN without any.
    """

    pairs: int
    median: float
    percentile_95: float

    def __bool__(self):
        return self.pairs > 0


NOTHING = Difference(0, np.nan, np.nan)


def by_reciprocity(data):
    """The `Difference` of values f(wi, wo) and f(wo, wi) of a `Measured`."""
    if data.is_table:
        return _by_reciprocity_of_table(data.table)
    if data.has_lookup:
        return _by_lookup(data, data.samples.wo, data.samples.wi)
    samples = some_valid(data)
    rows, values = find_swapped(samples, data.anisotropic), samples.values
    return difference(values[rows[:, 0]], values[rows[:, 1]])


def by_mirror(data):
    """The `Difference` of values left and right of the plane of incidence of a `Measured`.

    It should be 0 for an isotropic material. Of an anisotropic one nothing is compared.
    """
    if data.anisotropic:
        return NOTHING
    if data.is_table:
        f = some_half_vectors(data.table)
        half = f.shape[-2] // 2  # cells at phi_d against those at -phi_d
        return difference(f[..., :half, :], f[..., : -half - 1 : -1, :])
    if data.has_lookup:
        return _by_lookup(data, *(w * [1, -1, 1] for w in (data.samples.wi, data.samples.wo)))
    samples = some_valid(data)
    rows, values = find_mirrored(samples, data.anisotropic), samples.values
    return difference(values[rows[:, 0]], values[rows[:, 1]])


def _by_reciprocity_of_table(table):
    """Of a table; the exchange of wi and wo adds π to phi_d."""
    half, odd = divmod(table.shape[-1], 2)
    if table.phi_d_period == np.pi or odd:
        return NOTHING
    f = some_half_vectors(table)
    return difference(f[..., :half, :], f[..., half:, :])


def _by_lookup(data, wi, wo):
    """Of the samples and the looked-up values at `wi`, `wo`, their images by a symmetry."""
    rows = np.flatnonzero(data.samples.valid)
    rows = rows[some_rows(len(rows))]
    return difference(data.samples.values[rows], data.eval(wi[rows], wo[rows]))


def find_swapped(samples, anisotropic):
    """Pairs of `Samples` of which one has the other's directions exchanged; rows (n, 2).

    Those of an isotropic material with θi = θo are left out: their exchange is a mirror image.
    """
    images = to_points(samples.wo, samples.wi, anisotropic)
    if not anisotropic:
        images[np.abs(images[:, 0] - images[:, 1]) < 2 * SAME] = np.inf
    return _match(to_points(samples.wi, samples.wo, anisotropic), images)


def find_mirrored(samples, anisotropic):
    """Pairs of `Samples`, left and right of the plane of incidence; rows (n, 2).

    None of an anisotropic material.
    """
    if anisotropic:
        return np.empty((0, 2), int)
    here = to_points(samples.wi, samples.wo)
    return _match(here, here * [1, 1, 1, -1])


def _match(here, images):
    """Pairs (n, 2) of different rows of `here`, of which one is the other's image; each once.

    `images`: of the rows of `here` by a symmetry; rows that are not finite have none.
    """
    from scipy.spatial import cKDTree

    asked = np.flatnonzero(np.isfinite(images).all(axis=1))
    distance, found = cKDTree(here).query(images[asked], distance_upper_bound=SAME)
    near = np.isfinite(distance)
    rows = np.sort(np.stack([asked[near], found[near]], axis=1), axis=1)
    return np.unique(rows[rows[:, 0] != rows[:, 1]], axis=0)


def relative_differences(a, b):
    """(a - b) / ½ (a + b) where both are positive; a flat array."""
    both = (a > 0) & (b > 0)  # False where one is NaN
    a, b = a[both], b[both]
    return 2 * (a - b) / (a + b)


def difference(a, b):
    """The `Difference` of the values `a` and `b`, of one shape."""
    found = np.abs(relative_differences(a, b))
    if not found.size:
        return NOTHING
    median, percentile = np.percentile(found, (50, 95))
    return Difference(found.size, float(median), float(percentile))
