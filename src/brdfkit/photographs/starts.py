"""Where the search for maps begins: photometric stereo, and a few widths of the highlight."""

import numpy as np

from brdfkit.photographs.numbers import CHANNELS, STEEPEST

WIDTHS = 0.08, 0.2, 0.45  # of the shape parameters that are searched, on their scale of 0 to 1
MATT = 0.6  # the share of the observations, the darker ones, that count as free of highlights
RIDGE = 0.02  # of photometric stereo: it leans to the plane of the sample where lights are few


def lambertian(seen):
    """(albedo (n, 3), normals (n, 3)) by photometric stereo on the darker observations [Woodham
    1980], as observed by `Observations`."""
    share = (seen.radiance / np.maximum(seen.irradiance, 1e-30)).mean(axis=2)
    share = np.where((seen.weights > 0).all(axis=2), share, np.inf)
    k = len(share)
    # highlights are what is brighter than most, relative to the cosine
    brightness = share / np.maximum(seen.to_light[..., 2], 0.05)
    rank = np.argsort(np.argsort(brightness, axis=0), axis=0)
    used = (rank < max(1, round(MATT * k))) & np.isfinite(share)
    share = np.where(used, share, 0)
    l = seen.to_light * used[..., None]
    matrix = np.einsum("kni,knj->nij", l, l) + RIDGE * k * np.diag([1.0, 1.0, 1e-3])
    vector = np.einsum("kni,kn->ni", l, share)
    found = np.linalg.solve(matrix, vector[..., None])[..., 0]
    flat = ~(found[:, 2] > 0)
    found[flat] = [0, 0, 1]
    normal = found / np.linalg.norm(found, axis=1, keepdims=True)
    normal[:, :2] = np.clip(normal[:, :2], -STEEPEST, STEEPEST)
    cosine = np.maximum((seen.to_light * normal).sum(axis=2), 0.05) * used
    lit = seen.irradiance * cosine[..., None]
    radiance = np.where(used[..., None], seen.radiance, 0)
    albedo = np.pi * (radiance * lit).sum(axis=0) / np.maximum((lit**2).sum(axis=0), 1e-30)
    return np.maximum(albedo, 0), normal


def rows(numbers, seen, width):
    """Rows (n, count) to begin at: a width of the highlight, at `width` between its bounds."""
    albedo, normal = lambertian(seen)
    low, high = numbers.limits()
    x = np.zeros((len(albedo), numbers.count))
    x[:, :CHANNELS] = albedo
    x[:, CHANNELS : numbers.shapes.start] = 0.1
    at = numbers.shapes
    x[:, at] = low[at] + width**0.5 * (high[at] - low[at])
    x[:, numbers.normal] = normal[:, :2]
    return x
