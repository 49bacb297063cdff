"""Two ratios of medians: one tells what instruments do near the horizon, one retroreflection."""

import numpy as np

LEAST = 20  # samples on either side
GRAZING, STEEP = 80, (60, 70)  # degrees
NEAR, OBLIQUE = 5, 15  # degrees


def grazing(data):
    """The BRDF beyond 80° over that between 60° and 70°, of the larger angle of a pair.

    Reflectances of surfaces hold or rise towards the horizon; a goniometer's fall where the spot
    outgrows the sample or its rows are filled by a line down to 0. NaN where not both are measured.
    """
    samples = data.samples
    cosine = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    beyond, below, above = (np.cos(np.radians(angle)) for angle in (GRAZING, *STEEP))
    return _ratio(samples, cosine < beyond, (cosine < below) & (cosine > above))


def retroreflection(data):
    """The BRDF within 5° of the light over that within 5° of the mirror direction.

    At incidences of 15° and more; NaN where not both are measured.
    """
    samples = data.samples
    oblique = samples.wi[:, 2] < np.cos(np.radians(OBLIQUE))
    near = np.cos(np.radians(NEAR))
    to_light = np.einsum("nk,nk->n", samples.wi, samples.wo)
    to_mirror = 2 * samples.wi[:, 2] * samples.wo[:, 2] - to_light
    return _ratio(samples, oblique & (to_light > near), oblique & (to_mirror > near))


def _ratio(samples, these, those):
    values = [samples.values[samples.valid & rows] for rows in (these, those)]
    if min(map(len, values)) < LEAST:
        return np.nan
    one, other = (float(np.median(v.mean(axis=1))) for v in values)
    return one / other if other > 0 else np.nan
