"""Tests whether the residuals of the pictures are noise, or something the scene cannot explain.

Noise of one pixel is independent of noise in others, beyond the width of the camera's
reconstruction filter. Residuals that correlate over larger distances come from model errors.
Correlated pixels also count as fewer independent ones, which makes standard errors larger.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.scenes.problem.leverage import find_block_side
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search.normal_equations import Residuals

# Larger residuals, such as those at edges, are clipped to this number of robust standard deviations
CLIP_DEVIATIONS = 3
LAGS = 6  # largest distance of compared pixels, in widths of the camera's filter
SMALLEST_CORRELATION = 0.1  # smallest correlation that counts; a smaller one may be chance
# Residuals may be noise if the correlation of neighbours is below this number of standard errors
SIGNIFICANT = 5
CLEAR_CHI2 = 1.25  # χ² per degree of freedom that is clearly above 1, the value for pure noise


@dataclass(frozen=True)
class ResidualNoise:
    """The correlations of residuals, which tell noise from model errors.

    chi2 : a lower estimate of χ² per degree of freedom, squared residuals over those of pure noise.
    significance : the correlation of neighbours in units of its standard error.
    area : the number of neighbouring blocks, as wide as the filter, that count as one independent
        sample because their residuals are correlated.
    """

    chi2: float
    significance: float
    area: float

    @property
    def is_noise(self) -> bool:
        """Whether the residuals may be noise, as neighbours hardly correlate or χ² is near 1."""
        return self.significance < SIGNIFICANT or self.chi2 < CLEAR_CHI2

    @classmethod
    def measure(cls, views: Views, here: Residuals) -> ResidualNoise:
        """Return the correlations between neighbouring pixels of the residuals `here`.

        A pixel of one rendering is multiplied with its neighbour in the other one, because the
        noise of the two renderings is independent.
        """
        root = np.sqrt(views.weights)
        parts = (views.split_pictures(part) for part in (root, root * here.a, root * here.b))
        sums, near = np.zeros((2, 2 * LAGS + 1, 2 * LAGS + 1)), np.zeros(3)
        for sensor, weights, a, b in zip(views.sensors, *parts, strict=True):
            side, counted = find_block_side(sensor), (weights > 0).astype(float)
            a, b = _clip_outliers(a, b, counted)
            sums += _correlate_pictures(a, b, counted, side)
            near += _correlate_rows(a, b, counted, side)
            # With swapped axes, `_correlate_rows` compares the pixels along columns
            a, b, counted = (array.swapaxes(0, 1) for array in (a, b, counted))
            near += _correlate_rows(a, b, counted, side)
        products, squares, variance = near
        if not (squares > 0 and variance > 0):
            return cls(1.0, 0.0, 1.0)
        share = np.clip(products / squares, 0, 0.999)
        correlation = sums[0] / np.where(sums[1] > 0, sums[1], np.inf)
        correlation[LAGS, LAGS] = 1
        area = correlation[correlation > SMALLEST_CORRELATION].sum()
        return cls(float(1 / (1 - share)), float(products / np.sqrt(variance)), float(area))


def _clip_outliers(
    a: FloatArray, b: FloatArray, counted: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the residuals `a` and `b` of two renderings, with outliers clipped.

    The limit is three robust standard deviations of (a + b) / 2. `counted` is the mask of usable
    values.
    """
    size = np.abs(a + b)[counted > 0] / 2
    size = size[size > 0]
    limit = CLIP_DEVIATIONS * 1.4826 * np.median(size) if len(size) else 0.0
    return np.clip(a, -limit, limit), np.clip(b, -limit, limit)


def _correlate_rows(a: FloatArray, b: FloatArray, counted: FloatArray, side: int) -> FloatArray:
    """Return sums from which the correlation of pixels with those `side` rows below follows.

    They are the sum of products of both pixels, the sum of their squares, and the squared standard
    error of the first sum. `a` and `b` are the residuals (height, width, channels) of two
    renderings; `counted` is the mask of usable values.
    """
    upper, lower = (np.s_[:-side], np.s_[side:])
    both = counted[upper] * counted[lower]
    products = (both * (a[upper] * b[lower] + b[upper] * a[lower]) / 2).sum(axis=2)
    squares = (both * (a[upper] * b[upper] + a[lower] * b[lower]) / 2).sum()
    # Blocks as wide as the camera's filter have independent noise, since only the filter mixes it
    height, width = (n // side for n in products.shape)
    blocks = products[: height * side, : width * side].reshape(height, side, width, side)
    return np.array([products.sum(), squares, (blocks.sum(axis=(1, 3)) ** 2).sum()])


def _correlate_pictures(a: FloatArray, b: FloatArray, counted: FloatArray, side: int) -> FloatArray:
    """Return sums over pairs of pixels, from which their correlation by distance follows.

    The result (2, lags, lags) has the sums of the products and of the squares of pixels whose
    distances along the axes are -6 to 6 times `side`. `a` and `b` are residuals of two renderings,
    `counted` is the mask of usable values. Fourier transforms compute all sums at once; margins of
    zeros keep opposite edges apart.
    """
    from scipy.fft import irfft2, next_fast_len, rfft2

    shape = [next_fast_len(n + LAGS * side) for n in a.shape[:2]]
    at = np.arange(-LAGS, LAGS + 1) * side

    def correlate(one: FloatArray, other: FloatArray) -> FloatArray:
        """Return the cross-correlation (lags, lags) of two pictures, summed over channels."""
        spectrum = np.conj(rfft2(one, shape, axes=(0, 1))) * rfft2(other, shape, axes=(0, 1))
        correlation: FloatArray = irfft2(spectrum.sum(axis=2), shape, axes=(0, 1))
        return correlation[np.ix_(at, at)]

    products, squares = correlate(a, b), correlate(a * b, counted)
    return np.array([pair + pair[::-1, ::-1] for pair in (products, squares)]) / 2
