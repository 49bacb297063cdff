"""Tests whether measured values are the BRDF times cos theta_o, in place of the BRDF.

Two tests estimate the power p for which the values are the BRDF times cos^p theta_o. One looks at
reciprocity, the other at values near the horizon. p is 1 if the values contain the cosine, and
about 0 if not.
"""

import numpy as np

from brdfkit.materials.auditing.ratios import compute_light_and_mirror_cosines, cos_degrees
from brdfkit.materials.auditing.subsets import draw_valid_samples
from brdfkit.materials.auditing.symmetries import find_swapped_pairs
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.evidence import compute_weighted_median
from brdfkit.model.samples import Samples

# The test by reciprocity needs this number of sample pairs with exchanged directions. In each pair
# cos theta_i and cos theta_o must differ at least by the factor LEAST_FACTOR
FEWEST_PAIRS, LEAST_FACTOR = 6, 1.2
# The test by reciprocity reports a cosine if it finds a power of cos theta_o in this range, and if
# the power 1 leaves at most the share LARGEST_REST of the differences unexplained. It does so for
# none of 194 materials, and for 188 of them after a multiplication by the cosine
RECIPROCAL_POWERS, LARGEST_REST = (0.6, 1.4), 0.45
# Ranges of theta_o [degrees] whose values the test near the horizon compares: one near the horizon,
# and the first of the steeper ones that has enough samples
GRAZING_RANGE, STEEPER_RANGES = (67.5, 89.5), ((39.5, 60.5), (19.5, 39.5))
# The test near the horizon compares samples with equal theta_i, to within bins of BIN degrees. It
# needs FEWEST_SAMPLES in each range of theta_o, with views at least FROM_LIGHT degrees from the
# light and FROM_MIRROR degrees from the mirror direction
FEWEST_SAMPLES, BIN, FROM_LIGHT, FROM_MIRROR = 2, 5, 15, 35
# The test near the horizon reports a cosine if it finds a power of cos theta_o in this range. None
# of 199 materials has a power above 0.64; multiplied by the cosine, 191 of them are in the range
HORIZON_POWERS = (0.7, 1.5)

BY_RECIPROCITY = "exchanging wi and wo changes them as it changes this cosine"
BY_HORIZON = (
    "they fall towards the horizon as this cosine does, where those of most surfaces do not"
)


def explain_suspected_cosine(data: Measured) -> str:
    """Return the reason why a `Measured` seems to contain the BRDF times cos theta_o, or "".

    Samples are tested by reciprocity if enough pairs have exchanged directions, otherwise by how
    they fall towards the horizon. Tables, and file formats with their own interpolation, are not
    tested, because their definitions say what they contain.
    """
    if data.is_table or data.has_lookup:
        return ""
    samples = draw_valid_samples(data)
    power, unexplained, pairs = compute_cosine_power_by_reciprocity(samples, data.anisotropic)
    if pairs >= FEWEST_PAIRS:
        agrees = _is_within(power, RECIPROCAL_POWERS) and unexplained <= LARGEST_REST
        return BY_RECIPROCITY if agrees else ""
    return (
        BY_HORIZON if _is_within(compute_cosine_power_at_horizon(samples), HORIZON_POWERS) else ""
    )


def compute_cosine_power_by_reciprocity(
    samples: Samples, anisotropic: bool
) -> tuple[float, float, int]:
    """Estimate the power p of cos theta_o that values f of valid samples contain, by reciprocity.

    Pairs of samples with exchanged directions give p, because the BRDF itself is reciprocal:
    f(wi, wo) / f(wo, wi) = (cos theta_o / cos theta_i)^p. The second result is the median error of
    p = 1 in the logarithm of this equation, divided by the median logarithm of the cosines' ratio.
    The third is the number of pairs. Without any pair the results are NaN, NaN, 0.
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
    power = compute_weighted_median(ratios / cosines, np.abs(cosines))
    unexplained = np.median(np.abs(ratios - cosines)) / np.median(np.abs(cosines))
    return power, float(unexplained), len(cosines)


def compute_cosine_power_at_horizon(samples: Samples) -> float:
    """Estimate the power p for which valid samples fall towards the horizon as cos^p theta_o.

    The result is the median over the angles of incidence. It is NaN if no angle has enough samples,
    both near the horizon and nearer to the normal, far from the light and the mirror direction.
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
