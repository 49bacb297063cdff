"""Estimates the noise of photographs from the residuals that a fit of pixels leaves.

A fit follows a part of the noise. With the rows j_i of its Jacobian, the weights w_i of its robust
loss, and M = Σ_i w_i j_i j_iᵀ, a residual keeps the share 1 - h_i of its variance, where
h_i = w_i j_iᵀ M⁻¹ j_i is its leverage [Hoaglin & Welsch 1978]. So each residual is divided by
√(1 - h_i), before their median absolute value is taken.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.jit.double_precision import to_array, to_vector
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.inverse.photographs.objects.equations import CUT, Reflection
from brdfkit.inverse.photographs.objects.fit_pixels import Pixels
from brdfkit.inverse.photographs.objects.frames import make_tangents, tilt
from brdfkit.inverse.photographs.objects.prediction import TINY, predict
from brdfkit.inverse.photographs.objects.tile import Tile, to_numpy

STEP = 1e-4  # slopes by which normals are tilted for differences
RIDGE = 1e-9  # added to the diagonal of a matrix, as a share of it
LEAST_SHARE = 0.05  # residuals that keep less of their variance tell nothing of the noise


@dataclass(frozen=True)
class Rows:
    """The Jacobian's rows for n pixels in k photographs, in units of relative residuals.

    lobes : derivatives (k, n, channels, lobes) with respect to the weights of the own channel.
    slopes : derivatives (k, n, channels, 2) with respect to the slopes of the normal.
    residuals : relative differences (k, n, channels) of predictions from values.
    weights : weights (k, n) by the robust loss.
    bright : which residuals (k, n, channels) are those of bright values.
    """

    lobes: FloatArray
    slopes: FloatArray
    residuals: FloatArray
    weights: FloatArray
    bright: BoolArray


def measure_noise(
    tile: Tile,
    reflection: Reflection,
    pixels: Pixels,
    values: FloatArray,
    irradiance: FloatArray,
    scale: float,
    brightness: float,
) -> float | None:
    """Return the standard deviation of relative residuals, or None if too few residuals tell it.

    The fitted `pixels` are those of the tile. `values` (k, n, 3) of photographs are nan where they
    do not count; `irradiance` (k, n, 3) is that of surfaces which face the lights, and `scale` the
    scale of residuals of the fit. Values above half of the `brightness`, a typical ratio of values
    to irradiance, are bright.
    """
    rows = _collect_rows(tile, reflection, pixels, values, irradiance, scale, brightness)
    kept = 1 - _compute_leverages(rows, pixels.weights > 0)
    usable = rows.bright & (kept > LEAST_SHARE)
    if not usable.any():
        return None
    standard = np.abs(rows.residuals[usable]) / np.sqrt(kept[usable])
    return 1.4826 * float(np.median(standard))


def _collect_rows(
    tile: Tile,
    reflection: Reflection,
    pixels: Pixels,
    values: FloatArray,
    irradiance: FloatArray,
    scale: float,
    brightness: float,
) -> Rows:
    """Return the rows of the Jacobian by differences; for arguments see `measure_noise`."""
    n, weights = pixels.normals, pixels.weights
    lobe_count = weights.shape[2]
    single = [np.broadcast_to(np.eye(lobe_count)[k], weights.shape) for k in range(lobe_count)]
    tilted = [_tilt(n, p, q) for p, q in ((STEP, 0), (-STEP, 0), (0, STEP), (0, -STEP))]
    series = [
        predict(tile, reflection, n, weights),
        *(predict(tile, reflection, n, one) for one in single),
        *(predict(tile, reflection, other, weights) for other in tilted),
    ]
    shape = *values.shape, lobe_count
    lobes, slopes = np.zeros(shape, np.float32), np.zeros((*shape[:-1], 2), np.float32)
    residuals, bright = np.zeros(shape[:-1]), np.zeros(shape[:-1], bool)
    counted = np.zeros(shape[:2])
    for light, parts in enumerate(zip(*series, strict=True)):
        (predicted, faces), *others = parts
        value, power = values[light], irradiance[light]
        counts = np.isfinite(value).all(axis=1) & faces & (power.max(axis=1) > 0)
        value = np.where(counts[:, None], value, 0)
        lit = counts[:, None] & (power > 0)
        size = np.maximum(value, 0) + reflection.dark_offset * power
        factor = np.where(lit, 1 / np.maximum(size, TINY), 0)
        residuals[light] = factor * (predicted - value)
        y = np.minimum((residuals[light] ** 2).mean(axis=1) / (CUT * scale) ** 2, 1)
        counted[light] = np.where(counts, (1 - y) ** 2, 0)
        own = [radiance * factor for radiance, _ in others]
        lobes[light] = np.stack(own[:lobe_count], axis=2)
        up, down, right, left = own[lobe_count:]
        slopes[light] = np.stack([up - down, right - left], axis=2) / (2 * STEP)
        is_bright = predicted.mean(axis=1) > brightness / 2 * power.mean(axis=1)
        bright[light] = lit & (is_bright & (value.mean(axis=1) > 0))[:, None]
    return Rows(lobes, slopes, residuals, counted, bright)


def _compute_leverages(rows: Rows, free: BoolArray) -> FloatArray:
    """Return the leverages (k, n, channels); weights (n, channels, lobes) are `free` or at 0."""
    lobe_count = rows.lobes.shape[3]
    pixels, size = rows.lobes.shape[1], CHANNELS * lobe_count + 2
    w = rows.weights
    lobes = rows.lobes * free
    matrix = np.zeros((pixels, size, size))
    for c in range(CHANNELS):
        own = slice(c * lobe_count, (c + 1) * lobe_count)
        a, p = lobes[:, :, c], rows.slopes[:, :, c]
        matrix[:, own, own] = np.einsum("kn,kna,knb->nab", w, a, a, optimize=True)
        matrix[:, own, -2:] = np.einsum("kn,kna,knb->nab", w, a, p, optimize=True)
        matrix[:, -2:, own] = matrix[:, own, -2:].transpose(0, 2, 1)
        matrix[:, -2:, -2:] += np.einsum("kn,kna,knb->nab", w, p, p, optimize=True)
    diagonal = np.einsum("naa->na", matrix)
    # unit diagonals make the ridge equally strong for all unknowns
    unit = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1))
    matrix *= unit[:, :, None] * unit[:, None, :]
    inverse = np.linalg.inv(matrix + np.where(diagonal > 0, RIDGE, 1)[:, :, None] * np.eye(size))
    inverse *= unit[:, :, None] * unit[:, None, :]
    leverages = np.empty(rows.residuals.shape)
    for c in range(CHANNELS):
        chosen = np.r_[c * lobe_count : (c + 1) * lobe_count, size - 2, size - 1]
        row = np.concatenate([lobes[:, :, c], rows.slopes[:, :, c]], axis=2)
        part = inverse[:, chosen[:, None], chosen]
        leverages[:, :, c] = w * np.einsum("kna,nab,knb->kn", row, part, row, optimize=True)
    return leverages


def _tilt(normals: FloatArray, p: float, q: float) -> FloatArray:
    """Return unit normals (n, 3) that are tilted by the slopes p and q along their tangents."""
    n = to_vector(normals)
    slopes = (to_array(np.full(len(normals), slope)) for slope in (p, q))
    return to_numpy(tilt(n, *make_tangents(n), *slopes))
