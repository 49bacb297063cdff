"""Finds the shape parameters of a model, such as widths of lobes, with which pixels fit best."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.objects.calibration import STEPS, Calibration, fit_from_start
from brdfkit.inverse.photographs.objects.fit_pixels import fit_pixels
from brdfkit.inverse.photographs.objects.tile import Tile

SCALE_OF_SHAPES = 0.2  # scale of the residuals with which shape parameters are compared
WIDEST, NARROWEST = 0.7, 0.03  # range of the widths of lobes that are tried
LARGEST_TRIAL = 10.0  # largest value of a shape parameter without a logarithm that is tried
TRIALS = 9  # values of a shape parameter in the first round
FINER = 0.3, 0.1  # steps of the next rounds around the best value, as shares of the first step


def find_shapes(
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
