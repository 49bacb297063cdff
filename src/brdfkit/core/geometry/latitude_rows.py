"""What the rows of maps by latitude and longitude weigh in integrals over all directions.

Two kinds of maps differ in where their rows stand: those of files have a row at each pole, and are
linear between rows, as Mitsuba's `envmap` reads them; those that brdfkit makes for itself have
constant pixels, no row at a pole. Columns are even in both.
"""

import numpy as np


def solid_angles(height, width, at_poles):
    """Solid angle (height,) [sr] of a pixel of each row.

    at_poles : whether rows stand at the poles and the map is linear between them, or each pixel is
        constant. The share of a row is then ∫ of its weight, or over its pixel.

    >>> (solid_angles(3, 1, at_poles=False).sum() / np.pi).round(9)
    np.float64(4.0)
    """
    return _weights(height, width, at_poles, lambda a: -np.sin(a), lambda a: -np.cos(a))


def projected_solid_angles(height, width):
    """∫ cosθ dω (height,) [sr] over the upper hemisphere, of a pixel of each row of a file's map.

    >>> (projected_solid_angles(5, 1).sum() / np.pi).round(9)
    np.float64(1.0)
    """

    def once(theta):
        return np.sin(np.minimum(theta, np.pi / 2)) ** 2 / 2

    def twice(theta):
        up, down = np.minimum(theta, np.pi / 2), np.maximum(theta - np.pi / 2, 0)
        return up / 4 - np.sin(2 * up) / 8 + down / 2

    return _weights(height, width, True, twice, once)


def _weights(height, width, at_poles, twice, once):
    """∫ g(θ) dω of a pixel of each row: `once` is the integral of g(θ) sinθ over θ, `twice` that of
    `once`.

    A row's weight rises and falls linearly between its neighbours; by parts, its integral is the
    difference of the mean slopes of `twice` on both sides, that of `once` at the poles themselves.
    """
    if at_poles:
        theta = np.linspace(0, np.pi, height)
        slopes = np.diff(twice(theta)) / np.diff(theta)
        edges = np.concatenate([[once(0.0)], slopes, [once(np.pi)]])
    else:
        edges = once(np.linspace(0, np.pi, height + 1))
    return 2 * np.pi / width * np.diff(edges)
