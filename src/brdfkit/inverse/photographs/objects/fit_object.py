"""Fits all pixels of an object, tile by tile, so that the work can be interrupted and resumed.

The first pass fits each pixel by itself. The second pass begins there, and draws weights that the
photographs do not determine to their usual values, and normals to the mean of their neighbours. The
third pass computes standard errors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import uniform_filter

from brdfkit.core.array_types import FloatArray
from brdfkit.core.interrupts import Interrupted, is_interrupt
from brdfkit.core.jit.double_precision import to_vector
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, TexelParameters
from brdfkit.inverse.photographs.objects.calibrate import calibrate
from brdfkit.inverse.photographs.objects.calibration import (
    STEPS,
    Calibration,
    fit_from_start,
)
from brdfkit.inverse.photographs.objects.equations import compute_equations
from brdfkit.inverse.photographs.objects.fit_pixels import fit_pixels, split_weights
from brdfkit.inverse.photographs.objects.small_systems import compute_variances
from brdfkit.inverse.photographs.objects.tile import Tile, split_into_tiles

NEIGHBOURS = 3  # side of the square [pixels] over which normals are averaged for the second pass
# Standard deviation [radians] of a normal from the mean of its neighbours; smaller deviations are
# taken for noise where the photographs do not say otherwise
NORMAL_SPREAD = 0.03
CALIBRATION_REPORTS = 4  # reports of the calibration besides those of shape parameters
PASSES = 3


@dataclass
class FittedObject:
    """The state of a fit: what is finished of it, and where it goes on.

    calibration : what all pixels share, or None at the start.
    normals : unit normals (n, 3).
    weights : weights (n, channels, lobes) of the model's lobes.
    normal_errors : standard errors (n,) of the normals [radians].
    weight_errors : standard errors (n, channels, lobes) of the weights.
    lights : the numbers (n,) of photographs that count.
    expected_normals : the means (n, 3) of neighbouring normals after the first pass.
    finished : the number of finished tiles, over all passes.
    """

    calibration: Calibration | None
    normals: FloatArray
    weights: FloatArray
    normal_errors: FloatArray
    weight_errors: FloatArray
    lights: FloatArray
    expected_normals: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    finished: int = 0

    @classmethod
    def begin(cls, pixels: int, lobes: int) -> FittedObject:
        """Return the state before the first pass over some pixels."""
        shape = pixels, CHANNELS, lobes
        normals = np.zeros((pixels, 3))
        normals[:, 2] = 1
        return cls(
            None,
            normals,
            np.zeros(shape),
            np.full(pixels, np.nan),
            np.full(shape, np.nan),
            np.zeros(pixels),
        )


def estimate_reports(capture: ObjectCapture, parameters: TexelParameters) -> int:
    """Return how often `fit_object` reports, for its progress bar."""
    tiles = split_into_tiles(capture.values.shape[1], len(capture.lights))
    return CALIBRATION_REPORTS + 6 * len(parameters.names) + PASSES * len(tiles)


def fit_object(
    capture: ObjectCapture,
    parameters: TexelParameters,
    state: FittedObject | None,
    report: Callable[[], object],
) -> FittedObject:
    """Return the fitted normals and weights of all pixels of a capture.

    `state` is that of an interrupted fit, or None. On Ctrl-C `Interrupted` holds the state so far.
    """
    pixels = capture.values.shape[1]
    tiles = split_into_tiles(pixels, len(capture.lights))
    state = state or FittedObject.begin(pixels, len(parameters.lobes))
    try:
        if state.calibration is None:
            state.calibration = calibrate(capture, parameters, report)
        for number in range(state.finished, PASSES * len(tiles)):
            work = (_fit_alone, _fit_with_neighbours, _measure_errors)[number // len(tiles)]
            if work is _fit_with_neighbours and number == len(tiles):
                state.expected_normals = _average_normals(capture, state.normals)
            rows = tiles[number % len(tiles)]
            work(Tile.collect(capture, rows, state.calibration.exposures), rows, state)
            state.finished = number + 1
            report()
    except (KeyboardInterrupt, RuntimeError) as error:  # within loops, Dr.Jit raises the latter
        if not is_interrupt(error):
            raise
        raise Interrupted(state) from None
    return state


def _fit_alone(tile: Tile, rows: slice, state: FittedObject) -> None:
    """Fit the pixels of a tile, each by itself, and store them in the state."""
    assert state.calibration is not None
    known = state.calibration
    pixels = fit_from_start(tile, known)
    state.normals[rows], state.weights[rows] = pixels.normals, pixels.weights


def _fit_with_neighbours(tile: Tile, rows: slice, state: FittedObject) -> None:
    """Fit the pixels of a tile with what is known besides, and store them in the state."""
    assert state.calibration is not None
    known = state.calibration
    prior = known.make_prior(state.expected_normals[rows], NORMAL_SPREAD)
    pixels = fit_pixels(
        tile,
        known.reflection,
        state.normals[rows],
        state.weights[rows],
        known.scale,
        2 * STEPS,
        prior,
    )
    state.normals[rows], state.weights[rows] = pixels.normals, pixels.weights
    state.lights[rows] = pixels.lights


def _measure_errors(tile: Tile, rows: slice, state: FittedObject) -> None:
    """Compute the standard errors of the pixels of a tile, and store them in the state."""
    assert state.calibration is not None
    known = state.calibration
    n, a = to_vector(state.normals[rows]), split_weights(state.weights[rows])
    prior = known.make_prior(state.expected_normals[rows], NORMAL_SPREAD)
    equations = compute_equations(tile, known.reflection, n, a, known.scale, prior)
    weights, normals = compute_variances(equations)
    state.normal_errors[rows] = known.noise * np.sqrt(np.maximum(np.array(normals), 0))
    for c in range(CHANNELS):
        for k, variance in enumerate(weights[c]):
            root = np.sqrt(np.maximum(np.array(variance), 0))
            state.weight_errors[rows, c, k] = known.noise * root


def _average_normals(capture: ObjectCapture, normals: FloatArray) -> FloatArray:
    """Return for each pixel the unit mean (n, 3) of the normals around it."""
    picture = capture.to_picture(normals)
    sums: FloatArray = uniform_filter(picture, size=(NEIGHBOURS, NEIGHBOURS, 0), mode="constant")
    means = sums[capture.mask]
    length = np.linalg.norm(means, axis=1, keepdims=True)
    return np.where(length > 0, means / np.maximum(length, 1e-12), normals)
