"""Measures the exposures of photographs of an object, and how far predictions are from them."""

from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.objects.calibration import Calibration
from brdfkit.inverse.photographs.objects.fit_pixels import Pixels
from brdfkit.inverse.photographs.objects.prediction import compute_relative_differences, predict
from brdfkit.inverse.photographs.objects.tile import Tile

SMALLEST_NOISE = 1e-4


def measure_exposures(
    capture: ObjectCapture, chosen: AnyArray, tile: Tile, pixels: Pixels, known: Calibration
) -> Calibration:
    """Return the calibration with exposures and noise that the fitted pixels show.

    The exposure of a photograph is the median ratio of its values to the predicted ones. Only
    ratios of exposures can be found, so their geometric mean stays 1.
    """
    logarithms, residuals, count = [], [], 0.0
    predictions = predict(tile, known.reflection, pixels.normals, pixels.weights)
    _, irradiance = capture.lights.illuminate(capture.points[chosen])
    lost = np.zeros((1, 1, 1), bool) if capture.lost is None else capture.lost[:, chosen]
    lost = np.broadcast_to(lost, irradiance.shape)
    for light, (predicted, faces) in enumerate(predictions):
        values = capture.values[light, chosen].astype(float)
        counts = faces & ~lost[light].any(axis=1) & (values.mean(axis=1) > 0)
        power = irradiance[light].mean(axis=1)
        share = np.divide(predicted.mean(axis=1), power, out=np.zeros(len(power)), where=power > 0)
        counts &= share > known.dark_offset
        ratio = values[counts].mean(axis=1) / predicted[counts].mean(axis=1)
        logarithms.append(float(np.median(np.log(ratio))) if counts.any() else 0.0)
        floor = known.dark_offset * irradiance[light]
        bright = counts & (share > known.brightness / 2)
        differences = compute_relative_differences(predicted, values, floor)
        lit = irradiance[light] > 0
        residuals.append(differences[bright[:, None] & lit])
        count += (counts[:, None] & lit).sum() / len(counts)
    channels = int((irradiance > 0).any(axis=(0, 1)).sum())
    free = max(count - channels * len(known.parameters.lobes) - 2, 0.2 * count)
    joined = np.concatenate(residuals)
    # where nothing is as bright as predicted, the noise stays what it was taken for
    deviation = 1.4826 * float(np.median(np.abs(joined))) if len(joined) else known.noise
    noise = deviation * np.sqrt(count / max(free, 1e-9))
    change = np.exp(np.array(logarithms) - np.mean(logarithms))
    return replace(known, exposures=known.exposures * change, noise=max(noise, SMALLEST_NOISE))
