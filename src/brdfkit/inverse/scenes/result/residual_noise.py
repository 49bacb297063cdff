"""What is left of the pictures: noise, or something that the scene cannot explain.

Noise of one pixel says nothing of another's. Where what is left of pixels that are as far apart as
the camera's filter is wide goes together, it is no noise; and as many pixels as are alike tell no
more than one of them.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.inverse.scenes.problem.leverage import block_side

FAR = 3  # robust standard deviations, beyond which a pixel counts no more: edges would decide alone
LAGS = 6  # filters, as far as pixels are held beside each other
ALIKE = 0.1  # a correlation that is more than chance
SURE = 5  # standard errors, as far off 0 as no noise is
CLEAR = 1.25  # χ² per degree of freedom, that is clearly above 1


@dataclass(frozen=True)
class Rest:
    """What is left: `chi2`, at least the χ² per degree of freedom, its square over that of noise
    alone; by how many standard errors neighbours go together, `sure`; and the `area`, how many
    filters are alike."""

    chi2: float
    sure: float
    area: float

    @property
    def is_noise(self):
        """Whether nothing speaks against it."""
        return self.sure < SURE or self.chi2 < CLEAR

    @classmethod
    def of(cls, views, here):
        """That of `Residuals`: correlations of their halves, of which rendering adds nothing."""
        root = np.sqrt(views.weights)
        parts = (views.as_pictures(part) for part in (root, root * here.a, root * here.b))
        table, near = np.zeros((2, 2 * LAGS + 1, 2 * LAGS + 1)), np.zeros(3)
        for sensor, weights, a, b in zip(views.scene.sensors(), *parts, strict=True):
            side, counts = block_side(sensor), (weights > 0).astype(float)
            a, b = _clip(a, b, counts)
            table += _correlations(a, b, counts, side)
            near += sum(_beside(*turned, side) for turned in _both_ways(a, b, counts))
        together, alone, square = near
        if not (alone > 0 and square > 0):
            return cls(1.0, 0.0, 1.0)
        share = np.clip(together / alone, 0, 0.999)
        alike = table[0] / np.where(table[1] > 0, table[1], np.inf)
        alike[LAGS, LAGS] = 1
        area = alike[alike > ALIKE].sum()
        return cls(float(1 / (1 - share)), float(together / np.sqrt(square)), float(area))


def _clip(a, b, counts):
    """Both halves, none farther from 0 than most."""
    size = np.abs(a + b)[counts > 0] / 2
    size = size[size > 0]
    far = FAR * 1.4826 * np.median(size) if len(size) else 0.0
    return np.clip(a, -far, far), np.clip(b, -far, far)


def _both_ways(*arrays):
    """The arrays (height, width, channels), and on their sides."""
    return arrays, [array.swapaxes(0, 1) for array in arrays]


def _beside(a, b, counts, side):
    """Of pixels, and those `side` rows below: the sum of their products, that of their squares, and
    the square of the former's standard error."""
    upper, lower = (np.s_[:-side], np.s_[side:])
    both = counts[upper] * counts[lower]
    products = (both * (a[upper] * b[lower] + b[upper] * a[lower]) / 2).sum(axis=2)
    alone = (both * (a[upper] * b[upper] + a[lower] * b[lower]) / 2).sum()
    # within a filter noise is tied together: the standard error is that of blocks
    height, width = (n // side for n in products.shape)
    blocks = products[: height * side, : width * side].reshape(height, side, width, side)
    return np.array([products.sum(), alone, (blocks.sum(axis=(1, 3)) ** 2).sum()])


def _correlations(a, b, counts, side):
    """(2, lags, lags): sums of the products of pixels so many filters apart, and of their squares,
    by Fourier transforms of the pictures, with margins."""
    from scipy.fft import irfft2, next_fast_len, rfft2

    shape = [next_fast_len(n + LAGS * side) for n in a.shape[:2]]
    at = np.arange(-LAGS, LAGS + 1) * side

    def correlate(one, other):
        spectrum = np.conj(rfft2(one, shape, axes=(0, 1))) * rfft2(other, shape, axes=(0, 1))
        return irfft2(spectrum.sum(axis=2), shape, axes=(0, 1))[np.ix_(at, at)]

    together, alone = correlate(a, b), correlate(a * b, counts)
    return np.array([pair + pair[::-1, ::-1] for pair in (together, alone)]) / 2
