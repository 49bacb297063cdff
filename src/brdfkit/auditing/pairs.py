"""Direction pairs as points: how near two are, and which are the same by a symmetry.

The distance of two pairs is about the angle [rad] by which their directions differ, from 1/√2 of
it to 3/2. Of an isotropic material only the azimuth between the directions counts: the common
rotation that brings two pairs nearest leaves sin θi sin θo / √(sin² θi + sin² θo) of their
azimuths' difference.
"""

from dataclasses import dataclass

import numpy as np

SAME = np.radians(0.5)  # directions this near are taken for one


@dataclass(frozen=True)
class Difference:
    """Relative differences |a - b| / ½ (a + b) of positive values that a symmetry makes equal.

    `pairs`: how many values were compared; their `median` and `percentile_95`, NaN without any.
    """

    pairs: int
    median: float
    percentile_95: float

    def __bool__(self):
        return self.pairs > 0


NOTHING = Difference(0, np.nan, np.nan)


def points(wi, wo, anisotropic=False):
    """Direction pairs (n, 3) as points (n, 4), those of an anisotropic material (n, 6)."""
    if anisotropic:
        return np.concatenate([wi, wo], axis=-1)
    theta_i, theta_o = (np.arccos(np.clip(w[:, 2], -1, 1)) for w in (wi, wo))
    across_i, across_o = (w[:, 0] + 1j * w[:, 1] for w in (wi, wo))
    length = np.hypot(np.abs(across_i), np.abs(across_o))
    azimuth = across_i * across_o.conj() / np.maximum(length, 1e-12)
    return np.stack([theta_i, theta_o, azimuth.real, azimuth.imag], axis=-1)


def by_reciprocity(data):
    """The `Difference` of values f(wi, wo) and f(wo, wi) of a `Measured`."""
    if data.is_table:
        return _by_reciprocity_of_table(data.table)
    if data.has_lookup:
        return _by_lookup(data, data.samples.wo, data.samples.wi)
    rows = swapped(data)
    values = _valid(data).values
    return difference(values[rows[:, 0]], values[rows[:, 1]])


def by_mirror(data):
    """The `Difference` of values left and right of the plane of incidence of a `Measured`.

    An isotropic material has none; of an anisotropic one nothing is compared.
    """
    if data.anisotropic:
        return NOTHING
    if data.is_table:
        f = data.table.values
        half = f.shape[-2] // 2
        return difference(f[..., :half, :], f[..., : -half - 1 : -1, :])
    if data.has_lookup:
        return _by_lookup(data, *(w * [1, -1, 1] for w in (data.samples.wi, data.samples.wo)))
    rows = mirrored(data)
    values = _valid(data).values
    return difference(values[rows[:, 0]], values[rows[:, 1]])


def _by_reciprocity_of_table(table):
    half, odd = divmod(table.shape[-1], 2)
    if table.phi_d_period == np.pi or odd:
        return NOTHING
    return difference(table.values[..., :half, :], table.values[..., half:, :])


def _by_lookup(data, wi, wo):
    valid = data.samples.valid
    return difference(data.samples.values[valid], data.eval(wi[valid], wo[valid]))


def swapped(data):
    """Rows (n, 2) of the valid samples whose directions are exchanged.

    Where an isotropic material has θi = θo the exchange is a mirror image, and left out.
    """
    samples = _valid(data)
    images = points(samples.wo, samples.wi, data.anisotropic)
    if not data.anisotropic:
        images[np.abs(images[:, 0] - images[:, 1]) < 2 * SAME] = np.inf
    return _rows(points(samples.wi, samples.wo, data.anisotropic), images)


def mirrored(data):
    """Rows (n, 2) of the valid samples left and right of the plane of incidence."""
    if data.anisotropic:
        return np.empty((0, 2), int)
    samples = _valid(data)
    here = points(samples.wi, samples.wo)
    return _rows(here, here * [1, 1, 1, -1])


def _valid(data):
    return data.samples.at(data.samples.valid)


def _rows(here, images):
    """Pairs of different rows of which one is the other's image, each once."""
    from scipy.spatial import cKDTree

    asked = np.flatnonzero(np.isfinite(images).all(axis=1))
    distance, found = cKDTree(here).query(images[asked], distance_upper_bound=SAME)
    near = np.isfinite(distance)
    rows = np.sort(np.stack([asked[near], found[near]], axis=1), axis=1)
    return np.unique(rows[rows[:, 0] != rows[:, 1]], axis=0)


def relative(a, b):
    """(a - b) / ½ (a + b) where both are positive, flat."""
    both = (a > 0) & (b > 0)  # False where one is NaN
    a, b = a[both], b[both]
    return 2 * (a - b) / (a + b)


def difference(a, b):
    """The `Difference` of values `a` and `b` of one shape."""
    found = np.abs(relative(a, b))
    if not found.size:
        return NOTHING
    median, percentile = np.percentile(found, (50, 95))
    return Difference(found.size, float(median), float(percentile))
