"""Measures the usual weights of highlights on an object, and how much they differ."""

from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.jit.double_precision import to_vector
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.inverse.photographs.objects.calibration import Calibration
from brdfkit.inverse.photographs.objects.equations import compute_equations
from brdfkit.inverse.photographs.objects.fit_pixels import Pixels, split_weights
from brdfkit.inverse.photographs.objects.small_systems import compute_variances
from brdfkit.inverse.photographs.objects.tile import Tile

BEST_SHARE = 0.25  # share of the pixels, those with the surest highlights, that tell usual weights
SPREAD_ROUNDS = 4  # rounds in which the spread of usual weights is estimated
# The pixels that show highlights lie together, and others may differ more from them
SPREAD_FACTOR = 1.5
LEAST_SPREAD = 0.1  # smallest spread of usual weights, as a share of the weight
SMALLEST_SPREAD = 1e-3  # the same, as a share of the typical ratio of values to irradiance


def measure_usual_weights(tile: Tile, pixels: Pixels, known: Calibration) -> Calibration:
    """Return the calibration with the usual weights of highlights, and how much they differ.

    Only pixels in which the photographs determine a highlight well tell it: the weighted median of
    the surest ones.
    """
    n, a = to_vector(pixels.normals), split_weights(pixels.weights)
    equations = compute_equations(tile, known.reflection, n, a, known.scale)
    variances, _ = compute_variances(equations)
    usual, spreads = known.usual_weights.copy(), known.spreads.copy()
    for c in range(CHANNELS):
        for k in range(1, len(known.parameters.lobes)):
            variance = np.array(variances[c][k]) * known.noise**2
            weight = pixels.weights[:, c, k]
            sure = variance <= np.quantile(variance, BEST_SHARE)
            usual[c, k], spread = _find_centre_and_spread(weight[sure], variance[sure])
            least = SMALLEST_SPREAD * known.brightness
            spread = max(spread, LEAST_SPREAD * usual[c, k], least)
            spreads[c, k] = SPREAD_FACTOR * spread
    return replace(known, usual_weights=usual, spreads=spreads)


def _find_centre_and_spread(values: FloatArray, variances: FloatArray) -> tuple[float, float]:
    """Return the median of values that have known variances, and their spread beyond these.

    A value counts by the inverse of its whole variance, that of the spread included.
    """
    spread, centre = 0.0, 0.0
    for _ in range(SPREAD_ROUNDS):
        weights = 1 / (variances + spread**2)
        centre = _find_weighted_median(values, weights)
        deviation = 1.4826 * _find_weighted_median(np.abs(values - centre), weights)
        expected = _find_weighted_median(variances, weights)
        spread = float(np.sqrt(max(deviation**2 - expected, 0)))
    return centre, spread


def _find_weighted_median(values: FloatArray, weights: FloatArray) -> float:
    """Return the median of values whose counts are the weights."""
    order = np.argsort(values)
    sums = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(sums, sums[-1] / 2)])
