"""Finds what all pixels of an object share: exposures, widths of lobes, noise, and usual weights.

A few thousand pixels determine them. Their normals and weights are fitted again after each change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.jit.double_precision import to_scalar
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.maps.texel_parameters import TexelParameters
from brdfkit.inverse.photographs.objects.equations import Prior, Reflection, compute_equations
from brdfkit.inverse.photographs.objects.fit_pixels import Pixels, fit_pixels, split_weights
from brdfkit.inverse.photographs.objects.noise import measure_noise
from brdfkit.inverse.photographs.objects.photometric_stereo import estimate_normals
from brdfkit.inverse.photographs.objects.prediction import compute_relative_differences, predict
from brdfkit.inverse.photographs.objects.small_systems import compute_variances
from brdfkit.inverse.photographs.objects.tile import CHANNELS, Tile, to_vector

PIXELS = 12_000  # largest number of pixels that determine exposures, noise and usual weights
PAIRS = 300_000  # largest number of pairs of such a pixel and a photograph
SHARE_FOR_SHAPES = 0.2  # share of these numbers that determine the shape parameters
DARK_OFFSET = 0.05  # δ as a share of the typical ratio of values to irradiance
# Scales of relative residuals, in their order: large ones first, because the robust loss has one
# minimum for large scales, and its start is near the right one of several for small scales
SCALES = 0.2, 0.1, 0.05
STEPS = 4  # steps at each scale
SCALE_OF_NOISE = 2.0  # the last scale is this many standard deviations of the residuals
SMALLEST_SCALE = 0.005
SMALLEST_NOISE = 1e-4
# How often the exposures are estimated. Those that change with the direction of the light trade off
# with tilted normals, so that more rounds let both drift away
EXPOSURE_ROUNDS = 3
SCALE_OF_SHAPES = 0.2  # scale of the residuals with which shape parameters are compared
WIDEST, NARROWEST = 0.7, 0.03  # range of the widths of lobes that are tried
LARGEST_TRIAL = 10.0  # largest value of a shape parameter without a logarithm that is tried
TRIALS = 9  # values of a shape parameter in the first round
FINER = 0.3, 0.1  # steps of the next rounds around the best value, as shares of the first step
GLOSS_START = 0.05  # weight of each highlight at the start, as a share of the diffuse weight
BEST_SHARE = 0.25  # share of the pixels, those with the surest highlights, that tell usual weights
SPREAD_ROUNDS = 4  # rounds in which the spread of usual weights is estimated
# The pixels that show highlights lie together, and others may differ more from them
SPREAD_FACTOR = 1.5
LEAST_SPREAD = 0.1  # smallest spread of usual weights, as a share of the weight
SMALLEST_SPREAD = 1e-3  # the same, as a share of the typical ratio of values to irradiance
SMALLEST_BRIGHTNESS = 1e-30  # smallest ratio of values to irradiance, for photographs of nothing


@dataclass(frozen=True)
class Calibration:
    """What all pixels of an object share.

    parameters : the model, and which of its parameters are searched.
    shapes : the shape parameters by name.
    exposures : factors (k,) of the photographs' irradiances.
    dark_offset : what is added to values before errors are divided by them, per irradiance.
    noise : the standard deviation of relative residuals.
    usual_weights, spreads : the usual weights and their standard deviations (channels, lobes);
        these are infinite for the diffuse lobe.
    """

    parameters: TexelParameters
    shapes: dict[str, float]
    exposures: FloatArray
    dark_offset: float
    noise: float
    usual_weights: FloatArray
    spreads: FloatArray

    @property
    def reflection(self) -> Reflection:
        """The model with the shape parameters, as kernels need it."""
        shapes = {name: to_scalar(value) for name, value in self.shapes.items()}
        return Reflection(self.parameters.model, shapes, self.dark_offset)

    @property
    def scale(self) -> float:
        """The scale of relative residuals of the last search."""
        return max(SCALE_OF_NOISE * self.noise, SMALLEST_SCALE)

    @property
    def brightness(self) -> float:
        """The typical ratio of photographed values to irradiances."""
        return self.dark_offset / DARK_OFFSET

    def make_prior(self, normals: FloatArray | None = None, spread: float = 1.0) -> Prior:
        """Return the prior of the usual weights, and of expected normals (n, 3) if there are any.

        `spread` is the standard deviation [radians] from these. Residuals of a search are divided
        by a scale above the noise, and so are the deviations from what is expected.
        """
        factor = self.scale / self.noise
        weights, spreads = (
            [[to_scalar(value) for value in row] for row in values]
            for values in (self.usual_weights, self.spreads * factor)
        )
        expected = None if normals is None else to_vector(normals)
        return Prior(weights, spreads, expected, spread * factor)


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
            known = replace(known, shapes=_find_shapes(capture, few, known, report))
        tile = Tile.collect(capture, chosen, known.exposures)
        pixels = fit_from_start(tile, known)
        known = _measure_photographs(capture, chosen, tile, pixels, known)
        report()
    tile = Tile.collect(capture, chosen, known.exposures)
    # without a prior, which would draw the weights to itself
    pixels = fit_pixels(
        tile, known.reflection, pixels.normals, pixels.weights, known.scale, 2 * STEPS
    )
    known = _measure_noise_again(capture, chosen, tile, pixels, known)
    known = _measure_usual_weights(tile, pixels, known)
    report()
    return known


def fit_from_start(tile: Tile, known: Calibration) -> Pixels:
    """Return the fitted pixels of a tile, from photometric stereo by ever smaller scales."""
    normals, albedos = estimate_normals(tile, known.brightness)
    lobes = len(known.parameters.lobes)
    weights = np.repeat(albedos[:, :, None], lobes, axis=2)
    weights[..., 1:] *= GLOSS_START
    pixels = Pixels(normals, weights, np.zeros(0), np.zeros(0))
    for scale in [s for s in SCALES if s > known.scale] or SCALES[:1]:
        pixels = fit_pixels(tile, known.reflection, pixels.normals, pixels.weights, scale, STEPS)
    return pixels


def _measure_brightness(capture: ObjectCapture, chosen: AnyArray) -> float:
    """Return the mean ratio of the values of some pixels to the irradiance."""
    _, irradiance = capture.lights.illuminate(capture.points[chosen])
    values = capture.values[:, chosen]
    lit = irradiance > 0
    ratio = np.divide(values, irradiance, out=np.zeros(values.shape), where=lit)
    return float(max(ratio.sum() / max(lit.sum(), 1), SMALLEST_BRIGHTNESS))


def _find_shapes(
    capture: ObjectCapture, chosen: AnyArray, known: Calibration, report: Callable[[], object]
) -> dict[str, float]:
    """Return the shape parameters with which the chosen pixels fit best, one after the other."""
    tile = Tile.collect(capture, chosen, known.exposures)
    start = fit_from_start(tile, known)

    def measure_loss(shapes: dict[str, float]) -> float:
        """Return the mean loss of the pixels that are fitted with some shape parameters."""
        reflection = replace(known, shapes=shapes).reflection
        pixels = fit_pixels(
            tile, reflection, start.normals, start.weights, SCALE_OF_SHAPES, 2 * STEPS
        )
        return float(pixels.loss.mean())

    shapes = dict(known.shapes)
    for name in known.parameters.names:
        parameter = known.parameters.model.parameters[name]
        for values in _list_trials(known, name, shapes):
            losses = [measure_loss(shapes | {name: value}) for value in values]
            shapes[name] = _find_minimum(values, losses, parameter.log)
            report()
    return shapes


def _find_minimum(values: list[float], losses: list[float], is_log: bool) -> float:
    """Return where a parabola through the least of some losses and its neighbours is smallest.

    The values have equal steps, or where `is_log` equal ratios.
    """
    best = int(np.argmin(losses))
    if not 0 < best < len(values) - 1:
        return values[best]
    left, least, right = losses[best - 1 : best + 2]
    curvature = left - 2 * least + right
    shift = 0.5 * (left - right) / curvature if curvature > 0 else 0.0
    lower, middle, upper = values[best - 1 : best + 2]
    if is_log:
        return float(middle * np.sqrt(upper / lower) ** shift)
    return middle + shift * (upper - lower) / 2


def _list_trials(known: Calibration, name: str, shapes: dict[str, float]) -> Iterator[list[float]]:
    """Yield the values of a shape parameter to try: all over its range, then around the best one.

    `shapes` has the best value after the first values were tried.
    """
    parameter = known.parameters.model.parameters[name]
    low, high = parameter.bounds
    if parameter.log:
        low, high = max(low, NARROWEST), min(high, WIDEST)
        values = np.geomspace(low, high, TRIALS)
        yield values.tolist()
        step = float((high / low) ** (1 / (TRIALS - 1)))
        for width in FINER:
            near = shapes[name] * step ** (width * np.arange(-2, 3))
            yield np.clip(near, *parameter.bounds).tolist()
        return
    values = np.linspace(low, min(high, LARGEST_TRIAL), TRIALS)
    yield values.tolist()
    for width in FINER:
        near = shapes[name] + width * (values[1] - values[0]) * np.arange(-2, 3)
        yield np.clip(near, *parameter.bounds).tolist()


def _measure_photographs(
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


def _measure_usual_weights(tile: Tile, pixels: Pixels, known: Calibration) -> Calibration:
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
