"""Ratios of brightness at the horizon and near the light, which reveal faults of a measurement.

Each is a ratio of medians of `Samples`; NaN where one of the two was not measured.
"""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.model.samples import Samples

FEWEST_SAMPLES = 10  # for each of the two medians ...
FEWEST_IN_LARGE_STEPS = 3  # ... and for an instrument that takes large steps
GRAZING, STEEP = 80, (60, 70)  # degrees from the normal
NEAR_LIGHT = 5  # at most so many degrees from the light ...
# ... against at least so many from the light, the mirror direction and the horizon
FROM_LIGHT, FROM_MIRROR, FROM_HORIZON = 20, 30, 15
LARGE_STEP = 10  # degrees: counts as near the light, or near the mirror direction
OBLIQUE = 29.5  # degrees of incidence, at least: a little below 30, for rounded angles


def grazing_ratio(samples: Samples) -> float:
    """Return the median BRDF beyond 80° over the median between 60° and 70°.

    The larger angle of a pair counts. The BRDF of most surfaces stays equal or rises towards the
    horizon. A goniometer's values fall where its spot is larger than the sample, or where somebody
    filled rows by a line down to 0.
    """
    cosine = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    beyond, below, above = map(cos_degrees, (GRAZING, *STEEP))
    return _divide_medians(samples, cosine < beyond, (cosine < below) & (cosine > above))


def retroreflection_ratio(samples: Samples) -> float:
    """Return the median BRDF within 5° of the light over the median far from it.

    The incidence is 30° or more. Far means at least 20° from the light, 30° from the mirror
    direction and 15° from the horizon. The ratio is about 1 for diffuse surfaces, at most 2 for the
    roughest plaster and 30 for a reflective tape.
    """
    to_light, to_mirror = compute_light_and_mirror_cosines(samples)
    far = (to_light < cos_degrees(FROM_LIGHT)) & (to_mirror < cos_degrees(FROM_MIRROR))
    far &= samples.wo[:, 2] > cos_degrees(90 - FROM_HORIZON)
    oblique = samples.wi[:, 2] < cos_degrees(OBLIQUE)
    near = to_light > cos_degrees(NEAR_LIGHT)
    return _divide_medians(samples, oblique & near, oblique & far)


def backward_ratio(samples: Samples) -> float:
    """Return the median BRDF within 10° of the light over that within 10° of the mirror direction.

    The incidence is 30° or more. The ratio is at most about 1, and 17 for a reflective tape. It is
    as large where an instrument's mirror direction is at phi_o = phi_i.
    """
    to_light, to_mirror = compute_light_and_mirror_cosines(samples)
    oblique = samples.wi[:, 2] < cos_degrees(OBLIQUE)
    near = cos_degrees(LARGE_STEP)
    backward, forward = oblique & (to_light > near), oblique & (to_mirror > near)
    return _divide_medians(samples, backward, forward, FEWEST_IN_LARGE_STEPS)


def compute_light_and_mirror_cosines(samples: Samples) -> tuple[FloatArray, FloatArray]:
    """Return the cosines (n,) between wo and the light, and between wo and the mirror direction."""
    to_light = np.einsum("nk,nk->n", samples.wi, samples.wo)
    return to_light, 2 * samples.wi[:, 2] * samples.wo[:, 2] - to_light


def cos_degrees(degrees: float) -> float:
    """Return the cosine of an angle in degrees."""
    return float(np.cos(np.radians(degrees)))


def _divide_medians(
    samples: Samples, above: BoolArray, below: BoolArray, fewest: int = FEWEST_SAMPLES
) -> float:
    """Return the median of the valid samples `above` over the median of those `below`, two masks.

    The mean over the channels counts. NaN where one of them has less than the `fewest` samples.
    """
    values = [samples.values[samples.valid & rows] for rows in (above, below)]
    if min(map(len, values)) < fewest:
        return np.nan
    numerator, denominator = (float(np.median(v.mean(axis=1))) for v in values)
    return numerator / denominator if denominator > 0 else np.nan
