"""Compares the brightness at the horizon, and near the light, with that in other directions.

The results are ratios of two medians of `Samples`, which reveal faults of a measurement. They are
NaN where one of the two has too few samples.
"""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.model.samples import Samples

# Smallest numbers of samples of which a median is computed: in general, and for the backward ratio,
# which must also work for instruments that measure at few angles
FEWEST_SAMPLES, FEWEST_IN_LARGE_STEPS = 10, 3
# The grazing ratio compares the BRDF at angles to the normal beyond GRAZING degrees with the BRDF
# between the two angles of STEEP [degrees]
GRAZING, STEEP = 80, (60, 70)
# The retroreflection ratio compares views within NEAR_LIGHT degrees of the light with views that
# are at least FROM_LIGHT, FROM_MIRROR and FROM_HORIZON degrees from the light, the mirror direction
# and the horizon
NEAR_LIGHT = 5
FROM_LIGHT, FROM_MIRROR, FROM_HORIZON = 20, 30, 15
# The backward ratio compares views within this angle [degrees] of the light with views within the
# same angle of the mirror direction
LARGE_STEP = 10
# Smallest angle of incidence [degrees] of samples in the retroreflection and the backward ratio; it
# is a little below 30, because files round angles
OBLIQUE = 29.5


def compute_grazing_ratio(samples: Samples) -> float:
    """Return the median BRDF beyond 80° from the normal over the median between 60° and 70°.

    The larger one of the angles of light and view counts. The BRDF of most surfaces stays equal or
    rises towards the horizon. The ratio is small if a goniometer's spot is larger than the sample,
    or if somebody filled in unmeasured values that fall to 0.
    """
    cosine = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    beyond, below, above = map(cos_degrees, (GRAZING, *STEEP))
    return _divide_medians(samples, cosine < beyond, (cosine < below) & (cosine > above))


def compute_retroreflection_ratio(samples: Samples) -> float:
    """Return the median BRDF within 5° of the light over the median far from it.

    Only incidences of 30° or more count. Far means at least 20° from the light, 30° from the mirror
    direction and 15° from the horizon. The ratio is about 1 for diffuse surfaces, at most 2 for the
    roughest plaster, and 30 for a reflective tape.
    """
    to_light, to_mirror = compute_light_and_mirror_cosines(samples)
    far = (to_light < cos_degrees(FROM_LIGHT)) & (to_mirror < cos_degrees(FROM_MIRROR))
    far &= samples.wo[:, 2] > cos_degrees(90 - FROM_HORIZON)
    oblique = samples.wi[:, 2] < cos_degrees(OBLIQUE)
    near = to_light > cos_degrees(NEAR_LIGHT)
    return _divide_medians(samples, oblique & near, oblique & far)


def compute_backward_ratio(samples: Samples) -> float:
    """Return the median BRDF within 10° of the light over that within 10° of the mirror direction.

    Only incidences of 30° or more count. For most materials the ratio is at most about 1. It is 17
    for a reflective tape, and may be as large if an instrument has the mirror direction at
    phi_o = phi_i.
    """
    to_light, to_mirror = compute_light_and_mirror_cosines(samples)
    oblique = samples.wi[:, 2] < cos_degrees(OBLIQUE)
    near = cos_degrees(LARGE_STEP)
    backward, forward = oblique & (to_light > near), oblique & (to_mirror > near)
    return _divide_medians(samples, backward, forward, FEWEST_IN_LARGE_STEPS)


def compute_light_and_mirror_cosines(samples: Samples) -> tuple[FloatArray, FloatArray]:
    """Return the cosine (n,) between view and light, and between view and mirror direction."""
    to_light = np.einsum("nk,nk->n", samples.wi, samples.wo)
    return to_light, 2 * samples.wi[:, 2] * samples.wo[:, 2] - to_light


def cos_degrees(degrees: float) -> float:
    """Return the cosine of an angle in degrees."""
    return float(np.cos(np.radians(degrees)))


def _divide_medians(
    samples: Samples, above: BoolArray, below: BoolArray, fewest: int = FEWEST_SAMPLES
) -> float:
    """Return the median value of some samples, divided by the median value of others.

    The mask `above` (n,) selects the samples of the numerator, `below` those of the denominator.
    Valid samples count, with their mean over the channels. The result is NaN if one of the two
    medians has fewer than `fewest` samples.
    """
    values = [samples.values[samples.valid & rows] for rows in (above, below)]
    if min(map(len, values)) < fewest:
        return np.nan
    numerator, denominator = (float(np.median(v.mean(axis=1))) for v in values)
    return numerator / denominator if denominator > 0 else np.nan
