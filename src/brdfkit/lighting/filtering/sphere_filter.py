"""Convolution of environment maps with a rotationally symmetric kernel, and halving of their size.

Maps are by latitude and longitude, z up. The contribution of one row to another is a circular
convolution over the azimuth, which a Fourier transform turns into a product. The sum over all rows
is exact up to the map's own resolution, even at the poles.
"""

from collections.abc import Callable

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.core.geometry.latitude_rows import solid_angles

# A kernel is cut off along a row only this much beyond its reach, where a kernel that is small but
# not 0 has fallen so far that the cut adds no high frequencies
MARGIN = 1.25
NEGLIGIBLE = 1e-7  # frequencies weighted below this share of the largest weight are left out


def row_polar_angles(height: int) -> FloatArray:
    """Return the polar angles (height,) [rad] at the middles of a map's rows.

    >>> row_polar_angles(2)
    array([0.78539816, 2.35619449])
    """
    return (np.arange(height) + 0.5) * np.pi / height


def column_azimuths(width: int) -> FloatArray:
    """Return the azimuths (width,) [rad] at the middles of a map's columns.

    >>> column_azimuths(2)
    array([1.57079633, 4.71238898])
    """
    return (np.arange(width) + 0.5) * 2 * np.pi / width


def convolve_on_sphere(
    picture: FloatArray, kernel: Callable[[AnyArray], AnyArray], reach: float
) -> FloatArray:
    """Convolve a map over the sphere: ∫ picture(ω') kernel(ω·ω') dω' at each pixel's direction ω.

    `picture` is (height, width, channels) with an even width. `kernel` takes cosines of the angle
    between directions, and is 0 beyond the angle `reach` [rad].

    >>> def uniform(cos): return 1 / (4 * np.pi) + 0 * cos
    >>> convolve_on_sphere(np.ones((8, 16, 1)), uniform, np.pi)[0, 0, 0]
    np.float64(1.0)
    """
    height, width = picture.shape[:2]
    theta, rows = row_polar_angles(height), int(np.ceil(reach / np.pi * height))
    sin, cos = np.sin(theta)[:, None], np.cos(theta)[:, None]
    # cosines of azimuth differences; half a turn suffices, as the kernel is symmetric
    turn = np.cos(np.arange(width // 2 + 1) * 2 * np.pi / width)
    areas = solid_angles(height, width, at_poles=False)
    light = np.fft.rfft(picture * areas[:, None, None], axis=1)
    # Real and imaginary parts one after the other: the weights are real, and multiply both alike
    light = np.concatenate([light.real, light.imag], axis=2).transpose(0, 2, 1).copy()
    convolved = np.zeros_like(light)
    for i, columns in enumerate(_count_columns(sin[: (height + 1) // 2, 0], reach, width)):
        near = slice(max(i - rows, 0), i + rows + 1)
        cosines = cos[i] * cos[near] + sin[i] * sin[near] * turn[:columns]
        weights = _transform_symmetric_rows(kernel(np.clip(cosines, -1, 1)), width)
        largest = np.abs(weights).max(axis=0)
        kept = np.flatnonzero(largest > NEGLIGIBLE * largest.max())[-1] + 1
        # The row as far from the lower pole as row i is from the upper one has the same weights
        for way in (1, -1):
            lit = light[::way][near, :, :kept]
            convolved[::way][i, :, :kept] = np.einsum("jm,jcm->cm", weights[:, :kept], lit)
    real, imaginary = np.split(convolved.transpose(0, 2, 1), 2, axis=2)
    return np.fft.irfft(real + 1j * imaginary, width, axis=1)


def _count_columns(sin: FloatArray, reach: float, width: int) -> IntArray:
    """Return for rows with the sines `sin` (n,) of their polar angle how far a kernel spreads.

    The result (n,) is a number of columns, those of half a turn at most. A kernel with the `reach`
    [rad] reaches columns of less than this difference in azimuth on any row.
    """
    wide = MARGIN * reach
    sine = np.sin(wide) / sin if wide < np.pi / 2 else np.ones_like(sin)
    azimuths = np.where(sine < 1, np.arcsin(np.minimum(sine, 1)), np.pi)
    return np.minimum(np.ceil(azimuths / (2 * np.pi) * width).astype(int), width // 2) + 1


def _transform_symmetric_rows(values: FloatArray, width: int) -> FloatArray:
    """Return the Fourier transforms (n, width/2 + 1), which are real, of rows that are symmetric.

    `values` (n, columns) are the first pixels of the rows, up to half of the `width`; after these
    the rows are 0.
    """
    rows = np.zeros((len(values), width))
    columns = values.shape[1]
    rows[:, :columns] = values
    rows[:, width - columns + 1 :] = values[:, :0:-1]
    return np.fft.rfft(rows, axis=1).real


def halve_resolution(picture: FloatArray) -> FloatArray:
    """Halve the rows and columns of a `picture`; new pixels are means over solid angles.

    >>> halve_resolution(np.ones((4, 8, 1))).shape
    (2, 4, 1)
    """
    height, width = picture.shape[:2]
    area = solid_angles(height, width, at_poles=False)[:, None, None]
    four = (picture * area).reshape(height // 2, 2, width // 2, 2, -1).sum(axis=(1, 3))
    return four / (4 * area.reshape(-1, 2, 1, 1).mean(axis=1))
