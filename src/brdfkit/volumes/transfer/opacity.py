"""Opacity and extinction: a layer of thickness d transmits 1 - a = exp(-σ_t d) of the light.

VTK, Slicer and ParaView state the opacity `a` of a layer of their ScalarOpacityUnitDistance d. For
samples at another distance s their renderers compute 1 - (1 - a)^(s / d), which is the same.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_positive
from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray

OPAQUE = 0.9999  # largest opacity: that of 1 would have an infinite σ_t
TOLERANCE = 1e-5  # error of σ_t between points, relative to its largest value


def to_extinction(opacity: ArrayLike, distance: float) -> AnyArray:
    """Return σ_t [1/unit of length] of a layer of thickness `distance` with this `opacity`.

    >>> float(to_extinction(0.5, 2.0))
    0.34657359027997264
    """
    return -np.log1p(-np.minimum(opacity, OPAQUE)) / distance


def to_opacity(sigma: ArrayLike, distance: float) -> AnyArray:
    """Return the opacity of a layer of thickness `distance` with the extinction `sigma`."""
    return -np.expm1(-np.asarray(sigma) * distance)


def from_opacity(cls: Any, values: ArrayLike, rgba: ArrayLike, distance: float, colour: str) -> Any:
    """Return the transfer function, of the class `cls`, of points whose A are opacities."""
    opacities = cls(values, rgba, colour=colour)  # checks its arguments
    points, coefficients = _refine_points(opacities, to_positive("unit_distance", distance))
    largest = float(coefficients[:, 3].max()) or 1.0
    coefficients[:, 3] /= largest
    return cls(points, coefficients, largest, colour)


def _refine_points(function: Any, distance: float) -> tuple[FloatArray, FloatArray]:
    """Return points (k,) and their R, G, B and σ_t (k, 4), for a function whose A are opacities.

    Linear interpolation between them gives σ_t with an error below the TOLERANCE. A segment is
    divided into even steps h of σ_t, whose error is at most h² d / 8.
    """
    values, rgba, opacities = function.values, function.rgba, function.rgba[:, 3]
    sigma = to_extinction(opacities, distance)
    longest = math.sqrt(8 * TOLERANCE * sigma.max() / distance) or 1.0
    points, rows = [values[:1]], [np.append(rgba[0, :3], sigma[0])]
    for i in range(len(values) - 1):
        a, b = opacities[i : i + 2]
        parts = math.ceil(abs(sigma[i + 1] - sigma[i]) / longest)
        shares, steps = np.ones(1), sigma[i + 1 : i + 2]
        if parts > 1 and values[i] < values[i + 1]:  # otherwise it is a straight line, or a step
            steps = np.linspace(sigma[i], sigma[i + 1], parts + 1)
            shares = np.clip((to_opacity(steps, distance) - a) / (b - a), 0, 1)
            shares, steps = np.append(shares, 1), np.append(steps, sigma[i + 1])
        points.append(values[i] + shares * (values[i + 1] - values[i]))
        s = shares[:, None]
        rows.append(np.column_stack([(1 - s) * rgba[i, :3] + s * rgba[i + 1, :3], steps]))
    places, table = np.concatenate(points), np.vstack(rows)
    new = np.append(True, (np.diff(places) > 0) | (np.diff(table[:, 3]) != 0))
    return places[new], table[new]
