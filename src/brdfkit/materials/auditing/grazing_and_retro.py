"""Three ratios of medians of `Samples`: of values near the horizon, and near the light."""

import numpy as np

LEAST = 10  # samples that each of the two medians needs ...
FEW = 3  # ... and of the samples of an instrument that takes large steps
GRAZING, STEEP = 80, (60, 70)  # degrees from the normal
NEAR = 5  # at most so many degrees from the light ...
FAR, OFF_MIRROR, TO_HORIZON = 20, 30, 15  # ... against at least so many from light, mirror, horizon
BESIDE = 10  # degrees: within a large step of the light, and of the mirror direction
OBLIQUE = 29.5  # degrees of incidence, at least: a little below 30, for rounded angles


def grazing(samples):
    """The median BRDF beyond 80° over that between 60° and 70°; the larger angle of a pair counts.

    The BRDF of most surfaces stays equal or rises towards the horizon. A goniometer's values fall
    where its spot is larger than the sample, or where somebody filled rows by a line down to 0. NaN
    where one of the two was not measured.
    """
    cosine = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    beyond, below, above = map(_cos, (GRAZING, *STEEP))
    return _ratio(samples, cosine < beyond, (cosine < below) & (cosine > above))


def retroreflection(samples):
    """The median BRDF within 5° of the light over that far from it, at incidences from 30°.

    Far is also away from the mirror direction and from the horizon. About 1 for diffuse surfaces,
    at most 2 for the roughest plaster, 30 for a reflective tape. NaN where one of the two was not
    measured.
    """
    to_light = np.einsum("nk,nk->n", samples.wi, samples.wo)
    to_mirror = 2 * samples.wi[:, 2] * samples.wo[:, 2] - to_light
    away = (to_light < _cos(FAR)) & (to_mirror < _cos(OFF_MIRROR))
    away &= samples.wo[:, 2] > _cos(90 - TO_HORIZON)
    oblique = samples.wi[:, 2] < _cos(OBLIQUE)
    return _ratio(samples, oblique & (to_light > _cos(NEAR)), oblique & away)


def backwards(samples):
    """The median BRDF within 10° of the light over that within 10° of the mirror direction, at
    incidences from 30°.

    At most about 1, and 17 for a reflective tape: it is as large, too, where the azimuths are those
    of an instrument whose mirror direction is at phi_o = phi_i. NaN where one of the two was not
    measured.
    """
    to_light = np.einsum("nk,nk->n", samples.wi, samples.wo)
    to_mirror = 2 * samples.wi[:, 2] * samples.wo[:, 2] - to_light
    oblique = samples.wi[:, 2] < _cos(OBLIQUE)
    beside = _cos(BESIDE)
    return _ratio(samples, oblique & (to_light > beside), oblique & (to_mirror > beside), FEW)


def _cos(degrees):
    return np.cos(np.radians(degrees))


def _ratio(samples, these, those, least=LEAST):
    """The median of the valid samples `these` over that of `those`, of their channels' means."""
    values = [samples.values[samples.valid & rows] for rows in (these, those)]
    if min(map(len, values)) < least:
        return np.nan
    above, below = (float(np.median(v.mean(axis=1))) for v in values)
    return above / below if below > 0 else np.nan
