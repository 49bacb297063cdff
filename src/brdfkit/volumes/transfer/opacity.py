"""Opacity and extinction: a layer of thickness d lets 1 - a = exp(-σ_t d) of the light through.

VTK, Slicer and ParaView state the opacity `a` of a layer of their ScalarOpacityUnitDistance d; what
their renderers do with it for samples of another distance s, 1 - (1 - a)^(s / d), is exactly this.
"""

import math

import numpy as np

from brdfkit.core.arguments import to_positive

OPAQUE = 0.9999  # σ_t of an opacity of 1 has no end
TOLERANCE = 1e-5  # of σ_t between points, relative to its largest value


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
    points, rgba = refined(given, to_positive("unit_distance", distance))
    most = float(rgba[:, 3].max()) or 1.0
    rgba[:, 3] /= most
    return cls(points, rgba, most, colour)


def refined(given, distance):
    """Points (k,) of a transfer function whose A are opacities, and R, G, B and σ_t (k, 4) there.

    Linear between them, σ_t is off by less than the TOLERANCE. A segment is cut into even steps h
    of σ_t, of which the error is h² d / 8 at most.
    """
    values, opacities = given.values, given.rgba[:, 3]
    sigma = extinction(opacities, distance)
    longest = math.sqrt(8 * TOLERANCE * sigma.max() / distance) or 1.0
    points, found = [values[:1]], [np.append(given.rgba[0, :3], sigma[0])]
    for i in range(len(values) - 1):
        a, b = opacities[i : i + 2]
        parts = math.ceil(abs(sigma[i + 1] - sigma[i]) / longest)
        shares, steps = np.ones(1), sigma[i + 1 : i + 2]
        if parts > 1 and values[i] < values[i + 1]:  # else it is a straight line, or a step
            steps = np.linspace(sigma[i], sigma[i + 1], parts + 1)
            shares = np.clip((of_extinction(steps, distance) - a) / (b - a), 0, 1)
            shares, steps = np.append(shares, 1), np.append(steps, sigma[i + 1])
        points.append(values[i] + shares * (values[i + 1] - values[i]))
        s = shares[:, None]
        found.append(
            np.column_stack([(1 - s) * given.rgba[i, :3] + s * given.rgba[i + 1, :3], steps])
        )
    points, found = np.concatenate(points), np.vstack(found)
    new = np.append(True, (np.diff(points) > 0) | (np.diff(found[:, 3]) != 0))
    return points[new], found[new]
