"""Finds the directions of lights from photographs of a chrome ball, in which each is mirrored.

The camera is far away, so that all rays to it have the direction z. The ball's outline is a circle
with the centre c and the radius r, and at the mirrored light, at the place p, the normal is

    n = ((p - c) / r, sqrt(1 - |p - c|² / r²)).

The light is where a mirror with this normal throws the ray: l = 2 (n · z) n - z.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy import ndimage

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.pictures.coding import Coding
from brdfkit.inverse.photographs.capture.pictures.photograph_file import read_linear

HIGHLIGHT = 0.9  # share of the largest brightness above which a pixel belongs to the mirrored light
ROUNDEST = 0.97  # share of the circle's area that the mask of a ball covers at least
INNER = 0.97  # share of the radius within which lights are looked for: the edge mirrors all around


def find_light_directions(photographs: Sequence[Path], mask: BoolArray) -> FloatArray:
    """Return unit vectors (k, 3) to the lights that a chrome ball mirrors in `photographs`.

    `mask` (height, width) shows the ball. Raises `BrdfkitError` for a mask that is no disc, and
    for a photograph in which the ball mirrors no light.
    """
    centre, radius = fit_circle(mask, photographs[0].parent)
    return np.array([_find_direction(path, centre, radius) for path in photographs])


def find_light_directions_in_circle(
    photographs: Sequence[Path], centre: FloatArray, radius: float
) -> FloatArray:
    """Return unit vectors (k, 3) to the lights that a chrome ball mirrors in `photographs`.

    The ball's `centre` (2,) is column and row from the lower left, beginning at 1, as Matlab counts
    them; `radius` is in pixels.
    """
    height = len(read_linear(photographs[0], Coding())[0])
    from_above = np.array([centre[0] - 1, height - centre[1]])
    return np.array([_find_direction(path, from_above, radius) for path in photographs])


def fit_circle(mask: BoolArray, where: object) -> tuple[FloatArray, float]:
    """Return the centre (2,), column and row, and the radius [pixels] of a disc in a mask.

    `where` names the photographs in the `BrdfkitError` for a mask that is no disc.
    """
    rows, columns = np.nonzero(mask)
    extent = np.array([np.ptp(columns), np.ptp(rows)]) + 1
    radius = float(np.sqrt(len(rows) / np.pi))
    if not np.allclose(extent, 2 * radius, rtol=1 - ROUNDEST, atol=2):
        raise BrdfkitError(
            f"{where}: the mask of the chrome ball is no disc, as it is {extent[0]} × {extent[1]} "
            "pixels large; paint the whole ball white, and nothing else."
        )
    return np.array([columns.mean(), rows.mean()]), radius


def _find_direction(path: Path, centre: FloatArray, radius: float) -> FloatArray:
    """Return the unit vector (3,) to the light that the ball mirrors in a photograph.

    `centre` (2,) is column and row of the ball's middle, and `radius` its radius [pixels].
    """
    grey = read_linear(path, Coding())[0].mean(axis=2)
    rows, columns = np.indices(grey.shape)
    grey = grey * (np.hypot(columns - centre[0], rows - centre[1]) < INNER * radius)
    bright = grey > HIGHLIGHT * grey.max()
    pieces, count = ndimage.label(bright)
    if count == 0:
        raise BrdfkitError(f"{path}: the chrome ball is black in it; leave this photograph out.")
    largest = 1 + np.argmax(ndimage.sum_labels(grey, pieces, np.arange(1, count + 1)))
    row, column = ndimage.center_of_mass(grey, pieces, largest)
    x, y = (column - centre[0]) / radius, (centre[1] - row) / radius
    n = np.array([x, y, np.sqrt(max(0.0, 1 - x * x - y * y))])
    l = 2 * n[2] * n - [0, 0, 1]
    return l / np.linalg.norm(l)
