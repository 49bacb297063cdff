"""Tests whether the residuals of the pictures are noise, or something the scene cannot explain.

Noise of one pixel is independent of noise in others, beyond the width of the camera's
reconstruction filter. Residuals that correlate farther than that are model error. Correlated pixels
also count as fewer independent ones, which makes standard errors larger.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.scenes.problem.leverage import block_side
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search.normal_equations import Residuals

CLIP_DEVIATIONS = (
    3  # robust standard deviations, at which residuals are clipped: edges would decide
)
LAGS = 6  # filter widths, the largest distance at which pixels are compared
SMALLEST_CORRELATION = 0.1  # smaller ones may be chance
SIGNIFICANT = 5  # standard errors: noise does not correlate by more
CLEAR_CHI2 = 1.25  # per degree of freedom: clearly above 1


@dataclass(frozen=True)
class ResidualNoise:
    """The correlations of residuals, which tell noise from model errors.

    chi2 : a lower estimate of χ² per degree of freedom, squared residuals over those of pure noise.
    significance : the correlation of neighbours in units of its standard error.
    area : the number of blocks, as wide as the filter, whose residuals agree.
    """

    chi2: float
    significance: float
    area: float

    @property
    def is_noise(self) -> bool:
        """Whether the residuals may be noise alone."""
        return self.significance < SIGNIFICANT or self.chi2 < CLEAR_CHI2

    @classmethod
    def measure(cls, views: Views, here: Residuals) -> ResidualNoise:
        """Return the correlations of the two halves of `here`, to which rendering adds none."""
        root = np.sqrt(views.weights)
        parts = (views.split_pictures(part) for part in (root, root * here.a, root * here.b))
        sums, near = np.zeros((2, 2 * LAGS + 1, 2 * LAGS + 1)), np.zeros(3)
        for sensor, weights, a, b in zip(views.scene.sensors(), *parts, strict=True):
            side, counted = block_side(sensor), (weights > 0).astype(float)
            a, b = _clip(a, b, counted)
            sums += _correlate_pictures(a, b, counted, side)
            near += _compare_rows(a, b, counted, side)
            a, b, counted = (array.swapaxes(0, 1) for array in (a, b, counted))
            near += _compare_rows(a, b, counted, side)  # columns in place of rows
        products, squares, variance = near
        if not (squares > 0 and variance > 0):
            return cls(1.0, 0.0, 1.0)
        share = np.clip(products / squares, 0, 0.999)
        correlation = sums[0] / np.where(sums[1] > 0, sums[1], np.inf)
        correlation[LAGS, LAGS] = 1
        area = correlation[correlation > SMALLEST_CORRELATION].sum()
        return cls(float(1 / (1 - share)), float(products / np.sqrt(variance)), float(area))


def _clip(a: FloatArray, b: FloatArray, counted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return both halves clipped at three robust standard deviations of their mean."""
    size = np.abs(a + b)[counted > 0] / 2
    size = size[size > 0]
    limit = CLIP_DEVIATIONS * 1.4826 * np.median(size) if len(size) else 0.0
    return np.clip(a, -limit, limit), np.clip(b, -limit, limit)


def _compare_rows(a: FloatArray, b: FloatArray, counted: FloatArray, side: int) -> FloatArray:
    """Compare pixels with those `side` rows below, in pictures (height, width, channels).

    Returns three sums: of the products of both pixels, of their squares, and the squared standard
    error of the first.
    """
    upper, lower = (np.s_[:-side], np.s_[side:])
    both = counted[upper] * counted[lower]
    products = (both * (a[upper] * b[lower] + b[upper] * a[lower]) / 2).sum(axis=2)
    squares = (both * (a[upper] * b[upper] + a[lower] * b[lower]) / 2).sum()
    # Noise is correlated within the filter, so the standard error is that of whole blocks
    height, width = (n // side for n in products.shape)
    blocks = products[: height * side, : width * side].reshape(height, side, width, side)
    return np.array([products.sum(), squares, (blocks.sum(axis=(1, 3)) ** 2).sum()])


def _correlate_pictures(a: FloatArray, b: FloatArray, counted: FloatArray, side: int) -> FloatArray:
    """Return sums (2, lags, lags) of the products and of the squares of pixels that are apart.

    The distances are multiples of `side` up to `LAGS`, along both axes. The sums are computed by
    Fourier transforms of the pictures, with margins of zeros.
    """
    from scipy.fft import irfft2, next_fast_len, rfft2

    shape = [next_fast_len(n + LAGS * side) for n in a.shape[:2]]
    at = np.arange(-LAGS, LAGS + 1) * side

    def correlate(one: FloatArray, other: FloatArray) -> FloatArray:
        """Return the cross-correlation (lags, lags), summed over channels."""
        spectrum = np.conj(rfft2(one, shape, axes=(0, 1))) * rfft2(other, shape, axes=(0, 1))
        correlation: FloatArray = irfft2(spectrum.sum(axis=2), shape, axes=(0, 1))
        return correlation[np.ix_(at, at)]

    products, squares = correlate(a, b), correlate(a * b, counted)
    return np.array([pair + pair[::-1, ::-1] for pair in (products, squares)]) / 2
