"""Conversion of opacity to extinction, and of transfer functions in which A is an opacity.

A layer of thickness d with the opacity a transmits the share 1 - a = exp(-σ_t d) of the light. VTK,
Slicer and ParaView state a for d = ScalarOpacityUnitDistance. For samples at another distance s
their renderers use the opacity 1 - (1 - a)^(s / d), which follows from the same σ_t.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_positive_number
from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray

OPAQUE = 0.9999  # larger opacities count as this one, since 1 would need an infinite σ_t
TOLERANCE = 1e-5  # largest error of σ_t between control points, relative to the largest σ_t


def opacity_to_extinction(opacity: ArrayLike, distance: float) -> AnyArray:
    """Return the extinction [1/unit of length] of a layer of thickness `distance` by its `opacity`.

    >>> float(opacity_to_extinction(0.5, 2.0))
    0.34657359027997264
    """
    return -np.log1p(-np.minimum(opacity, OPAQUE)) / distance


def extinction_to_opacity(sigma: ArrayLike, distance: float) -> AnyArray:
    """Return the opacity of a layer of thickness `distance` with the extinction `sigma`."""
    return -np.expm1(-np.asarray(sigma) * distance)


def convert_opacities(
    cls: Any, values: ArrayLike, rgba: ArrayLike, distance: float, colour: str
) -> Any:
    """Make a transfer function, of the class `cls`, from points whose A are opacities of a layer.

    See `Conversions.from_opacity` for the arguments.
    """
    opacities = cls(values, rgba, colour=colour)  # the class checks the arguments
    points, coefficients = _refine_points(opacities, to_positive_number("unit_distance", distance))
    largest = float(coefficients[:, 3].max()) or 1.0
    coefficients[:, 3] /= largest
    return cls(points, coefficients, largest, colour)


def _refine_points(function: Any, distance: float) -> tuple[FloatArray, FloatArray]:
    """Return control points (k,), and R, G, B and σ_t there (k, 4), of a function with opacities.

    σ_t is not linear between the points of the `function`. The segments are thus divided, until
    linear interpolation of σ_t has an error below the TOLERANCE. If σ_t has even steps h, the error
    is at most h² d / 8, for the `distance` d.
    """
    values, rgba, opacities = function.values, function.rgba, function.rgba[:, 3]
    sigma = opacity_to_extinction(opacities, distance)
    longest = math.sqrt(8 * TOLERANCE * sigma.max() / distance) or 1.0
    points, rows = [values[:1]], [np.append(rgba[0, :3], sigma[0])]
    for i in range(len(values) - 1):
        a, b = opacities[i : i + 2]
        parts = math.ceil(abs(sigma[i + 1] - sigma[i]) / longest)
        shares, steps = np.ones(1), sigma[i + 1 : i + 2]
        if parts > 1 and values[i] < values[i + 1]:  # a flat segment or a jump stays as it is
            steps = np.linspace(sigma[i], sigma[i + 1], parts + 1)
            shares = np.clip((extinction_to_opacity(steps, distance) - a) / (b - a), 0, 1)
            shares, steps = np.append(shares, 1), np.append(steps, sigma[i + 1])
        points.append(values[i] + shares * (values[i + 1] - values[i]))
        s = shares[:, None]
        rows.append(np.column_stack([(1 - s) * rgba[i, :3] + s * rgba[i + 1, :3], steps]))
    places, table = np.concatenate(points), np.vstack(rows)
    new = np.append(True, (np.diff(places) > 0) | (np.diff(table[:, 3]) != 0))
    return places[new], table[new]
