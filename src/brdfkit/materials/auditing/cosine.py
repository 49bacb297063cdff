"""Whether values seem to be the BRDF times cos theta_o: by reciprocity, or else at the horizon.

Each test finds the power p of cos theta_o that the values have besides their BRDF. It is 1 where
the cosine was never divided out, and about 0 where it was.
"""

import numpy as np
from numpy.typing import NDArray

from brdfkit.materials.auditing.spread import some_valid
from brdfkit.materials.auditing.symmetries import find_swapped
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Samples

# By reciprocity: the least number of pairs, and the least factor between their two cosines
PAIRS, APART = 6, 1.2
# The powers that are a finding, and the largest share of the differences that p = 1 may leave: of
# 194 materials none has these; times the cosine, 188 of them have
RECIPROCAL, UNEXPLAINED = (0.6, 1.4), 0.45
# At the horizon: the ranges of theta_o [degrees] that are compared, the second of the steeper ones
# where the first has too few samples; within BIN degrees of theta_i, this far from light and mirror
GRAZING, STEEPER = (67.5, 89.5), ((39.5, 60.5), (19.5, 39.5))
SAMPLES, BIN, FROM_LIGHT, FROM_MIRROR = 2, 5, 15, 35
# The powers that are a finding: of 199 materials none is above 0.64; times the cosine, 191 of them
# have these
FALLING = (0.7, 1.5)

BY_RECIPROCITY = "exchanging wi and wo changes them as it changes this cosine"
BY_HORIZON = (
    "they fall towards the horizon as this cosine does, where those of most surfaces do not"
)


def suspected_cosine(data: Measured) -> str:
    """Why the values of a `Measured` seem to be the BRDF times cos theta_o; "" where they do not.

    Samples are tested by reciprocity where they have exchanged directions, else by how they fall
    towards the horizon. A table and what a format itself interpolates are not tested: they hold one
    value for a pair of directions and the exchanged one, or state what they are.
    """
    if data.is_table or data.has_lookup:
        return ""
    samples = some_valid(data)
    power, unexplained, pairs = power_by_reciprocity(samples, data.anisotropic)
    if pairs >= PAIRS:
        agree = _is_within(power, RECIPROCAL) and unexplained <= UNEXPLAINED
        return BY_RECIPROCITY if agree else ""
    return BY_HORIZON if _is_within(power_at_horizon(samples), FALLING) else ""


def power_by_reciprocity(samples: Samples, anisotropic: bool) -> tuple[float, float, int]:
    """The power p in f(wi, wo) / f(wo, wi) = (cos theta_o / cos theta_i)^p of valid `Samples`.

    With it: the median |ln| of the ratio that p = 1 leaves over that of the cosines, and the number
    of pairs; NaN, NaN, 0 without any.
    """
    first, second = find_swapped(samples, anisotropic).T
    values = samples.values.mean(axis=1)
    known = (values[first] > 0) & (values[second] > 0)
    cosines = np.log(samples.wo[first, 2] / samples.wi[first, 2])
    rows = known & (np.abs(cosines) > np.log(APART))
    if not rows.any():
        return np.nan, np.nan, 0
    cosines = cosines[rows]
    ratios = np.log(values[first[rows]]) - np.log(values[second[rows]])
    power = _weighted_median(ratios / cosines, np.abs(cosines))
    left = np.median(np.abs(ratios - cosines)) / np.median(np.abs(cosines))
    return power, float(left), len(cosines)


def power_at_horizon(samples: Samples) -> float:
    """The power of cos theta_o by which valid `Samples` fall towards the horizon.

    The median over the angles of incidence; NaN where none has samples of both kinds, far from the
    light and from the mirror direction.
    """
    to_light = np.einsum("nk,nk->n", samples.wi, samples.wo)
    to_mirror = 2 * samples.wi[:, 2] * samples.wo[:, 2] - to_light
    values, cosine = samples.values.mean(axis=1), samples.wo[:, 2]
    rows = (values > 0) & (to_light < _cos(FROM_LIGHT))
    rows &= to_mirror < _cos(FROM_MIRROR)
    incidence = np.round(np.degrees(np.arccos(np.clip(samples.wi[:, 2], -1, 1))) / BIN)
    low, *others = (
        rows & (cosine < _cos(near)) & (cosine > _cos(far)) for near, far in (GRAZING, *STEEPER)
    )
    powers = []
    for angle in np.unique(incidence[low]):
        bands = [band & (incidence == angle) for band in (low, *others)]
        grazing, *steeper = (np.log([cosine[band], values[band]]) for band in bands)
        steep = next((band for band in steeper if band.shape[1] >= SAMPLES), None)
        if steep is not None and grazing.shape[1] >= SAMPLES:
            dark, bright = np.median(grazing, axis=1), np.median(steep, axis=1)
            powers.append((dark - bright)[1] / (dark - bright)[0])
    return float(np.median(powers)) if powers else np.nan


def _cos(degrees: float) -> float:
    return float(np.cos(np.radians(degrees)))


def _is_within(power: float, ends: tuple[float, float]) -> bool:
    """Whether a power is within its `ends`; NaN is not."""
    return ends[0] <= power <= ends[1]


def _weighted_median(values: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, total[-1] / 2)])
