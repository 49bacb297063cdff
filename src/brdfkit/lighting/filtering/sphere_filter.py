"""Convolution of a map of all directions with a kernel that depends on the angle alone.

The map is by latitude and longitude, z up. Two of its rows, at the polar angles θ and θ', meet the
kernel k as a circular convolution over the azimuth, which a Fourier transform turns into a product.
The sum over the rows is exact up to the map's own resolution, at the poles too.
"""

from collections.abc import Callable

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.geometry.latitude_rows import solid_angles

NEGLIGIBLE = 1e-7  # share of the largest weight below which frequencies are left out


def row_angles(height: int) -> FloatArray:
    """Return the polar angles (height,) [rad] at the middles of the rows.

    >>> row_angles(2)
    array([0.78539816, 2.35619449])
    """
    return (np.arange(height) + 0.5) * np.pi / height


def azimuths(width: int) -> FloatArray:
    """Return the azimuths (width,) [rad] at the middles of the columns.

    >>> azimuths(2)
    array([1.57079633, 4.71238898])
    """
    return (np.arange(width) + 0.5) * 2 * np.pi / width


def convolve(
    picture: FloatArray, kernel: Callable[[AnyArray], AnyArray], reach: float
) -> FloatArray:
    """Compute ∫ picture(ω') kernel(ω·ω') dω' at the pixels ω of a `picture`.

    `picture` is (height, width, channels) with an even width. `kernel` takes cosines, and is 0
    beyond the angle `reach` [rad].

    >>> convolve(np.ones((8, 16, 1)), lambda cos: 1 / (4 * np.pi) + 0 * cos, np.pi)[0, 0, 0]
    np.float64(1.0)
    """
    from scipy.fft import dct, irfft, rfft

    height, width = picture.shape[:2]
    theta, rows = row_angles(height), int(np.ceil(reach / np.pi * height))
    sin, cos = np.sin(theta)[:, None], np.cos(theta)[:, None]
    turn = np.cos(np.arange(width // 2 + 1) * 2 * np.pi / width)  # half a turn: the kernel is even
    light = rfft(picture * solid_angles(height, width, at_poles=False)[:, None, None], axis=1)
    light = light.view(float)  # real and imaginary parts side by side, as the weights are real
    convolved = np.zeros_like(light)
    for i in range((height + 1) // 2):
        near = slice(max(i - rows, 0), i + rows + 1)
        cosines = cos[i] * cos[near] + sin[i] * sin[near] * turn
        weights = dct(kernel(np.clip(cosines, -1, 1)), type=1, axis=1)
        largest = np.abs(weights).max(axis=0)
        kept = np.flatnonzero(largest > NEGLIGIBLE * largest.max())[-1] + 1  # of the frequencies
        # The row as far from the other pole has the same weights
        for way in (1, -1):
            lit = light[::way][near, :kept]
            convolved[::way][i, :kept] = np.einsum("jm,jmc->mc", weights[:, :kept], lit)
    return irfft(convolved.view(complex), width, axis=1)


def halve(picture: FloatArray) -> FloatArray:
    """Return a picture of half as many rows and columns; pixels are means over solid angles.

    >>> halve(np.ones((4, 8, 1))).shape
    (2, 4, 1)
    """
    height, width = picture.shape[:2]
    area = solid_angles(height, width, at_poles=False)[:, None, None]
    four = (picture * area).reshape(height // 2, 2, width // 2, 2, -1).sum(axis=(1, 3))
    return four / (4 * area.reshape(-1, 2, 1, 1).mean(axis=1))
