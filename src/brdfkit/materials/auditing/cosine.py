"""Tests whether measured values are the BRDF times cos theta_o, in place of the BRDF.

Two tests, by reciprocity and by values near the horizon, estimate the power p for which the values
are the BRDF times cos^p theta_o. It is 1 if the values contain the cosine, and about 0 if not.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.materials.auditing.ratios import compute_light_and_mirror_cosines, cos_degrees
from brdfkit.materials.auditing.subsets import draw_valid_samples
from brdfkit.materials.auditing.symmetries import find_swapped_pairs
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Samples

# The test by reciprocity needs this number of pairs of samples, whose two cosines differ at least
# by this factor
FEWEST_PAIRS, LEAST_FACTOR = 6, 1.2
# It reports a power p within RECIPROCAL_POWERS if p = 1 leaves at most the share LARGEST_REST of
# the differences unexplained. Of 194 materials it reports none; multiplied by the cosine, it
# reports 188 of them
RECIPROCAL_POWERS, LARGEST_REST = (0.6, 1.4), 0.45
# The test near the horizon compares values in ranges of theta_o [degrees]: one near the horizon
# with the first steeper one that has enough samples
GRAZING_RANGE, STEEPER_RANGES = (67.5, 89.5), ((39.5, 60.5), (19.5, 39.5))
# It needs this number of samples in each range, whose theta_i are grouped in bins of BIN degrees,
# and which lie this far from the light and from the mirror direction [degrees]
FEWEST_SAMPLES, BIN, FROM_LIGHT, FROM_MIRROR = 2, 5, 15, 35
# It reports a power p in this range. Of 199 materials none has a power above 0.64; multiplied by
# the cosine, 191 of them are in the range
HORIZON_POWERS = (0.7, 1.5)

BY_RECIPROCITY = "exchanging wi and wo changes them as it changes this cosine"
BY_HORIZON = (
    "they fall towards the horizon as this cosine does, where those of most surfaces do not"
)


def explain_suspected_cosine(data: Measured) -> str:
    """Return the reason why a `Measured` seems to contain the BRDF times cos theta_o, or "".

    Samples are tested by reciprocity if some have the directions of others exchanged, otherwise by
    how they fall towards the horizon. Tables, and formats with their own interpolation, are not
    tested, because they define what they contain.
    """
    if data.is_table or data.has_lookup:
        return ""
    samples = draw_valid_samples(data)
    power, unexplained, pairs = compute_power_by_reciprocity(samples, data.anisotropic)
    if pairs >= FEWEST_PAIRS:
        agrees = _is_within(power, RECIPROCAL_POWERS) and unexplained <= LARGEST_REST
        return BY_RECIPROCITY if agrees else ""
    return BY_HORIZON if _is_within(compute_power_at_horizon(samples), HORIZON_POWERS) else ""


def compute_power_by_reciprocity(samples: Samples, anisotropic: bool) -> tuple[float, float, int]:
    """Estimate the power p of cos theta_o in valid samples f, by exchanging wi and wo.

    p solves f(wi, wo) / f(wo, wi) = (cos theta_o / cos theta_i)^p. The second result is the median
    |ln| of the ratio that p = 1 leaves unexplained, over the median |ln| of the cosines' ratio; the
    third is the number of pairs. Without any pair the results are NaN, NaN, 0.
    """
    first, second = find_swapped_pairs(samples, anisotropic).T
    values = samples.values.mean(axis=1)
    known = (values[first] > 0) & (values[second] > 0)
    cosines = np.log(samples.wo[first, 2] / samples.wi[first, 2])
    rows = known & (np.abs(cosines) > np.log(LEAST_FACTOR))
    if not rows.any():
        return np.nan, np.nan, 0
    cosines = cosines[rows]
    ratios = np.log(values[first[rows]]) - np.log(values[second[rows]])
    power = _compute_weighted_median(ratios / cosines, np.abs(cosines))
    unexplained = np.median(np.abs(ratios - cosines)) / np.median(np.abs(cosines))
    return power, float(unexplained), len(cosines)


def compute_power_at_horizon(samples: Samples) -> float:
    """Estimate the power p for which valid samples fall towards the horizon as cos^p theta_o.

    The result is the median over the angles of incidence. It is NaN where none has enough samples
    in both ranges of theta_o, far from the light and from the mirror direction.
    """
    to_light, to_mirror = compute_light_and_mirror_cosines(samples)
    values, cosine = samples.values.mean(axis=1), samples.wo[:, 2]
    rows = (values > 0) & (to_light < cos_degrees(FROM_LIGHT))
    rows &= to_mirror < cos_degrees(FROM_MIRROR)
    incidence = np.round(np.degrees(np.arccos(np.clip(samples.wi[:, 2], -1, 1))) / BIN)
    low, *others = (
        rows & (cosine < cos_degrees(near)) & (cosine > cos_degrees(far))
        for near, far in (GRAZING_RANGE, *STEEPER_RANGES)
    )
    powers = []
    for angle in np.unique(incidence[low]):
        bands = [band & (incidence == angle) for band in (low, *others)]
        grazing, *steeper = (np.log([cosine[band], values[band]]) for band in bands)
        steep = next((band for band in steeper if band.shape[1] >= FEWEST_SAMPLES), None)
        if steep is not None and grazing.shape[1] >= FEWEST_SAMPLES:
            run, rise = np.median(grazing, axis=1) - np.median(steep, axis=1)
            powers.append(rise / run)
    return float(np.median(powers)) if powers else np.nan


def _is_within(power: float, ends: tuple[float, float]) -> bool:
    """Return whether `power` lies between the two `ends`; False for NaN."""
    return ends[0] <= power <= ends[1]


def _compute_weighted_median(values: FloatArray, weights: FloatArray) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, total[-1] / 2)])
