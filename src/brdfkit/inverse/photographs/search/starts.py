"""Where the search for maps begins: matt and flat as a whole, and a few widths of the highlight."""

import numpy as np

from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS

WIDTHS = 0.08, 0.2, 0.45  # of the shape parameters that are searched, on their scale of 0 to 1
MATT = 0.6  # the share of the observations, the darker ones, that count as free of highlights


def albedos(seen):
    """Albedos (n, 3) of a matt and flat surface, from the darker ones of `Observations`.

    Normals by photometric stereo [Woodham 1980] are no better a start: where all lights are near
    the camera, as flashes are, they lean by 40° to where the search does not come back from.
    """
    cosine = np.maximum(seen.to_light[..., 2], 0.05)
    share = (seen.radiance / np.maximum(seen.irradiance, 1e-30)).mean(axis=2)
    brightness = np.where((seen.weights > 0).all(axis=2), share / cosine, np.inf)
    rank = np.argsort(np.argsort(brightness, axis=0), axis=0)
    used = (rank < max(1, round(MATT * len(share)))) & np.isfinite(brightness)
    lit = seen.irradiance * (cosine * used)[..., None]
    found = (seen.radiance * lit).sum(axis=0) / np.maximum((lit**2).sum(axis=0), 1e-30)
    return np.pi * np.maximum(found, 0)


def rows(numbers, seen, width):
    """Rows (n, count) to begin at: a width of the highlight, at `width` between its bounds."""
    low, high = numbers.limits()
    x = np.zeros((seen.radiance.shape[1], numbers.count))
    x[:, :CHANNELS] = albedos(seen)
    x[:, CHANNELS : numbers.shapes.start] = 0.1
    at = numbers.shapes
    x[:, at] = low[at] + width**0.5 * (high[at] - low[at])
    if numbers.pair:  # alike in all directions
        x[:, at.stop - 2 : at.stop] = 0
    return x
