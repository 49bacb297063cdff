"""Finds what all pixels of an object share: exposures, widths of lobes, noise, and usual weights.

A few thousand pixels determine them. Their normals and weights are fitted again after each change.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, TexelParameters
from brdfkit.inverse.photographs.objects.calibration import (
    DARK_OFFSET,
    SCALES,
    STEPS,
    Calibration,
    fit_from_start,
)
from brdfkit.inverse.photographs.objects.exposures import SMALLEST_NOISE, measure_exposures
from brdfkit.inverse.photographs.objects.fit_pixels import Pixels, fit_pixels
from brdfkit.inverse.photographs.objects.noise import measure_noise
from brdfkit.inverse.photographs.objects.shape_search import find_shapes
from brdfkit.inverse.photographs.objects.tile import Tile
from brdfkit.inverse.photographs.objects.usual_weights import measure_usual_weights

PIXELS = 12_000  # largest number of pixels that determine exposures, noise and usual weights
PAIRS = 300_000  # largest number of pairs of such a pixel and a photograph
SHARE_FOR_SHAPES = 0.2  # share of these numbers that determine the shape parameters
# How often the exposures are estimated. Those that change with the direction of the light trade off
# with tilted normals, so that more rounds let both drift away
EXPOSURE_ROUNDS = 3
SMALLEST_BRIGHTNESS = 1e-30  # smallest ratio of values to irradiance, for photographs of nothing


def calibrate(
    capture: ObjectCapture, parameters: TexelParameters, report: Callable[[], object]
) -> Calibration:
    """Return what all pixels of a capture share; `report` is called after each part of the work."""
    count = capture.values.shape[1]
    generator = np.random.default_rng(0)
    wanted = min(count, PIXELS, PAIRS // len(capture.lights))
    chosen = np.sort(generator.choice(count, wanted, replace=False))
    exposures = np.ones(len(capture.lights))
    defaults = parameters.model().values
    shapes = {
        name: float(np.asarray(defaults[name])) for name in parameters.names
    } | parameters.fixed
    channels, lobes = CHANNELS, len(parameters.lobes)
    brightness = _measure_brightness(capture, chosen)
    known = Calibration(
        parameters,
        shapes,
        exposures,
        DARK_OFFSET * brightness,
        SCALES[0],
        np.zeros((channels, lobes)),
        np.full((channels, lobes), np.inf),
    )
    enough = max(1, round(SHARE_FOR_SHAPES * min(PIXELS, PAIRS // len(capture.lights))))
    few = chosen[:: max(1, round(len(chosen) / enough))]
    for number in range(EXPOSURE_ROUNDS):
        if number < 2:
            known = replace(known, shapes=find_shapes(capture, few, known, report))
        tile = Tile.collect(capture, chosen, known.exposures)
        pixels = fit_from_start(tile, known)
        known = measure_exposures(capture, chosen, tile, pixels, known)
        report()
    tile = Tile.collect(capture, chosen, known.exposures)
    # without a prior, which would draw the weights to itself
    pixels = fit_pixels(
        tile, known.reflection, pixels.normals, pixels.weights, known.scale, 2 * STEPS
    )
    known = _measure_noise_again(capture, chosen, tile, pixels, known)
    known = measure_usual_weights(tile, pixels, known)
    report()
    return known


def _measure_brightness(capture: ObjectCapture, chosen: AnyArray) -> float:
    """Return the mean ratio of the values of some pixels to the irradiance."""
    _, irradiance = capture.lights.illuminate(capture.points[chosen])
    values = capture.values[:, chosen]
    lit = irradiance > 0
    ratio = np.divide(values, irradiance, out=np.zeros(values.shape), where=lit)
    return float(max(ratio.sum() / max(lit.sum(), 1), SMALLEST_BRIGHTNESS))


def _measure_noise_again(
    capture: ObjectCapture, chosen: AnyArray, tile: Tile, pixels: Pixels, known: Calibration
) -> Calibration:
    """Return the calibration with the noise that pixels show which were fitted without a prior."""
    values = capture.values[:, chosen].astype(float)
    if capture.lost is not None:
        values[capture.lost[:, chosen]] = np.nan
    _, irradiance = capture.with_exposures(known.exposures).lights.illuminate(
        capture.points[chosen]
    )
    noise = measure_noise(
        tile, known.reflection, pixels, values, irradiance, known.scale, known.brightness
    )
    return known if noise is None else replace(known, noise=max(noise, SMALLEST_NOISE))
