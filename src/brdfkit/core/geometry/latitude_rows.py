"""Computes the weights of the rows of latitude-longitude maps in integrals over all directions.

Two kinds of maps differ in where their rows lie. Maps from files have a row at each pole and are
linear between rows, as Mitsuba's `envmap` reads them; maps that brdfkit makes for itself have
constant pixels and no row at a pole. In both the columns are evenly spaced.
"""

from collections.abc import Callable

import numpy as np

from brdfkit.core.array_types import FloatArray


def solid_angles(height: int, width: int, at_poles: bool) -> FloatArray:
    """Return the solid angle (height,) [sr] of a pixel in each row of a latitude-longitude map.

    With `at_poles` the first and last rows lie at the poles and the map is linear between rows: a
    pixel then counts by the integral of its interpolation weight. Otherwise pixels are constant.

    >>> (solid_angles(3, 1, at_poles=False).sum() / np.pi).round(9)
    np.float64(4.0)
    """
    return _integrate_rows(height, width, at_poles, lambda a: -np.sin(a), lambda a: -np.cos(a))


def projected_solid_angles(height: int, width: int) -> FloatArray:
    """Return the integral (height,) [sr] of cosθ over the pixel of each row of a map file.

    Only the upper hemisphere counts. The map is linear between rows, and rows lie at the poles.

    >>> (projected_solid_angles(5, 1).sum() / np.pi).round(9)
    np.float64(1.0)
    """

    def first_integral(theta: FloatArray) -> FloatArray:
        return np.sin(np.minimum(theta, np.pi / 2)) ** 2 / 2

    def second_integral(theta: FloatArray) -> FloatArray:
        up, down = np.minimum(theta, np.pi / 2), np.maximum(theta - np.pi / 2, 0)
        return up / 4 - np.sin(2 * up) / 8 + down / 2

    return _integrate_rows(height, width, True, second_integral, first_integral)


def _integrate_rows(
    height: int,
    width: int,
    at_poles: bool,
    second_integral: Callable[..., FloatArray],
    first_integral: Callable[..., FloatArray],
) -> FloatArray:
    """Return ∫ g w dω [sr] for a pixel of each row, as an array (height,).

    g is a function of the polar angle θ, and w the weight of the pixel in interpolation. g is given
    by two integrals over θ: `first_integral`, of g(θ) sinθ, and `second_integral`, of
    `first_integral`. Without `at_poles`, w is 1 within the pixel. With `at_poles`, w falls linearly
    to 0 at the next rows. Then, by parts, the result is the difference of the mean slopes of
    `second_integral` below and above the row; beyond a pole, `first_integral` stands for the slope.
    """
    if at_poles:
        theta = np.linspace(0, np.pi, height)
        slopes = np.diff(second_integral(theta)) / np.diff(theta)
        edges = np.concatenate([[first_integral(0.0)], slopes, [first_integral(np.pi)]])
    else:
        edges = first_integral(np.linspace(0, np.pi, height + 1))
    return 2 * np.pi / width * np.diff(edges)
