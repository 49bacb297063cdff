"""Two ratios of medians: one tells what instruments do near the horizon, one retroreflection."""

import numpy as np

LEAST = 10  # samples on either side
GRAZING, STEEP = 80, (60, 70)  # degrees
# degrees: from the light; away from it, from the mirror direction and from the horizon; incidence
NEAR, FAR, OFF_MIRROR, TO_HORIZON, OBLIQUE = 5, 20, 30, 15, 29.5


def grazing(data):
    """The BRDF beyond 80° over that between 60° and 70°, of the larger angle of a pair.

    Reflectances of surfaces hold or rise towards the horizon; a goniometer's fall where the spot
    outgrows the sample or its rows are filled by a line down to 0. NaN where not both are measured.
    """
    samples = data.samples
    cosine = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    beyond, below, above = map(_cos, (GRAZING, *STEEP))
    return _ratio(samples, cosine < beyond, (cosine < below) & (cosine > above))


def retroreflection(data):
    """The BRDF within 5° of the light over that away from it, from the mirror direction and from
    the horizon, at incidences of 30° and more.

    About 1 for what is diffuse, at most 2 for the roughest plaster, 30 for a reflective tape. NaN
    where not both are measured.
    """
    samples = data.samples
    to_light = np.einsum("nk,nk->n", samples.wi, samples.wo)
    to_mirror = 2 * samples.wi[:, 2] * samples.wo[:, 2] - to_light
    away = (to_light < _cos(FAR)) & (to_mirror < _cos(OFF_MIRROR))
    away &= samples.wo[:, 2] > _cos(90 - TO_HORIZON)
    oblique = samples.wi[:, 2] < _cos(OBLIQUE)
    return _ratio(samples, oblique & (to_light > _cos(NEAR)), oblique & away)


def _cos(degrees):
    return np.cos(np.radians(degrees))


def _ratio(samples, these, those):
    values = [samples.values[samples.valid & rows] for rows in (these, those)]
    if min(map(len, values)) < LEAST:
        return np.nan
    one, other = (float(np.median(v.mean(axis=1))) for v in values)
    return one / other if other > 0 else np.nan
