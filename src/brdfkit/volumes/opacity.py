"""Opacity and extinction: a layer of thickness d lets 1 - a = exp(-σ_t d) of the light through.

VTK, Slicer and ParaView state the opacity `a` of a layer of their ScalarOpacityUnitDistance d; what
their renderers do with it for samples of another distance s, 1 - (1 - a)^(s / d), is exactly this.
"""

import math

import numpy as np

from brdfkit.arguments import to_positive

OPAQUE = 0.9999  # σ_t of an opacity of 1 has no end
TOLERANCE = 1e-3  # of σ_t between points, relative to its largest value


def extinction(opacity, distance):
    """σ_t [1/unit of length] of a layer of thickness `distance` with this `opacity`.

    >>> float(extinction(0.5, 2.0))
    0.34657359027997264
    """
    return -np.log1p(-np.minimum(opacity, OPAQUE)) / distance


def of_extinction(sigma, distance):
    """The opacity of a layer of thickness `distance`."""
    return -np.expm1(-np.asarray(sigma) * distance)


def function(cls, values, rgba, distance, colour):
    """The transfer function, of the class `cls`, of points whose A are opacities."""
    given = cls(values, rgba, colour=colour)  # checks them
    points, sigma = refined(given, to_positive("unit_distance", distance))
    most = float(sigma.max()) or 1.0
    result = given(points)
    result[:, 3] = sigma / most
    return cls(points, result, most, colour)


def refined(function, distance):
    """Points (k,) of a transfer function whose A are opacities, and σ_t (k,) at them.

    Linear between them, σ_t is off by less than the TOLERANCE. A segment is cut into even steps h
    of σ_t, of which the error is h² d / 8 at most.
    """
    values, opacities = function.values, function.rgba[:, 3]
    sigma = extinction(opacities, distance)
    longest = math.sqrt(8 * TOLERANCE * sigma.max() / distance) or 1.0
    points, found = [values[:1]], [sigma[:1]]
    for i in range(len(values) - 1):
        a, b = opacities[i : i + 2]
        parts = math.ceil(abs(sigma[i + 1] - sigma[i]) / longest)
        if parts > 1 and values[i] < values[i + 1]:  # else it is a straight line, or a step
            steps = np.linspace(sigma[i], sigma[i + 1], parts + 1)
            share = (of_extinction(steps, distance) - a) / (b - a)
            points.append(values[i] + np.clip(share, 0, 1) * (values[i + 1] - values[i]))
            found.append(steps)
        points.append(values[i + 1 : i + 2])
        found.append(sigma[i + 1 : i + 2])
    points, found = np.concatenate(points), np.concatenate(found)
    new = np.append(True, (np.diff(points) > 0) | (np.diff(found) != 0))
    return points[new], found[new]
