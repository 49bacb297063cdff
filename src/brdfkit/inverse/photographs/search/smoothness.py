"""Penalises differences between neighbouring texels, in proportion to the noise.

A difference of one unit times τ counts as much as a residual of one standard deviation of the
noise. So maps are smoothed more where the photographs are noisy.
"""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.observations import Observations
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, TexelParameters


def estimate_noise(
    parameters: TexelParameters, errors: FloatArray, observed: Observations
) -> float:
    """Return the variance of relative radiances, given E² (n,) of the texels.

    The median over texels is robust against those that the maps do not explain.
    """
    counted = (observed.weights > 0).sum(axis=(0, 2))
    free = np.maximum(counted - parameters.count, 0.2 * counted)
    return max(float(np.median(errors / np.maximum(free, 1))), 1e-10)


def compute_strength(
    parameters: TexelParameters,
    hessian: FloatArray,
    observed: Observations,
    noise: float,
    tau: float,
) -> FloatArray:
    """Return the weights (count,) of squared differences, σ² / τ², for each number in its unit.

    `noise` is σ², `tau` is τ, and `hessian` (n, count, count) determines the units.
    """
    return noise / (tau * find_units(parameters, hessian, observed)) ** 2


def find_units(
    parameters: TexelParameters, hessian: FloatArray, observed: Observations
) -> FloatArray:
    """Return the units (count,) of differences, from the Hessians of the texels.

    The unit of a weight is the one with which its lobe alone would be as bright as the photographs.
    The current weight would be a bad unit: one that is near 0 would then stay there.
    """
    of_weights = slice(0, parameters.shape_columns.start)
    brightness = np.diagonal(hessian, axis1=1, axis2=2)[:, of_weights]
    counted = (observed.weights > 0).sum(axis=(0, 2))[:, None] / CHANNELS
    alone = np.sqrt(counted / np.maximum(brightness, 1e-12 * counted + 1e-300))
    units, lit = np.ones(parameters.count), observed.lit_channels()
    median = np.median(alone[counted[:, 0] > 0], axis=0).reshape(-1, CHANNELS)
    units[of_weights] = np.repeat(median[:, lit].mean(axis=1), CHANNELS)
    return units


def sum_squared_differences(x: FloatArray, shape: tuple[int, int]) -> FloatArray:
    """Return the sums (count,) of squared differences of neighbours with numbers `x` (n, count)."""
    grid = x.reshape(*shape, -1)
    down, right = np.diff(grid, axis=0), np.diff(grid, axis=1)
    sums: FloatArray = (down**2).sum(axis=(0, 1)) + (right**2).sum(axis=(0, 1))
    return sums


def apply_laplacian(x: FloatArray, shape: tuple[int, int]) -> FloatArray:
    """Return half of the derivative (n, count) of `sum_squared_differences`."""
    grid = x.reshape(*shape, -1)
    result = np.zeros_like(grid)
    down, right = np.diff(grid, axis=0), np.diff(grid, axis=1)
    result[1:] += down
    result[:-1] -= down
    result[:, 1:] += right
    result[:, :-1] -= right
    return result.reshape(x.shape)
