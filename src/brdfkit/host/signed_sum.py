"""The sampling of weights that may be negative: of the sum of their lobes, clamped at 0.

No lobe of its own can be drawn from, so the sum is tabulated whenever a parameter changes, for the
mean of each texture.
"""

import numpy as np

from brdfkit.host.half_vector_table import Tabulated
from brdfkit.model.evaluation import lobe_values

# Polynomials are smooth
ISOTROPIC = {"azimuths": 1, "angles": 32, "cells": (24, 20), "points": 2}
ANISOTROPIC = {"azimuths": 12, "angles": 16, "cells": (24, 20), "points": 1}
BATCH = 8192  # directions at once: a model may have a thousand lobes
# Points along each side of a texture
TEXELS = 8
WAVELENGTHS = (450.0, 520.0, 590.0, 650.0)  # [nm]


def tabulated(model, weights, lobes):
    """The `Tabulated` of the sum over the indices `lobes` of a model with shape parameters, its
    `weights` (all lobes, channels)."""
    weights = weights[lobes]

    def f(wi, wo):
        values = np.empty((len(wi), weights.shape[1]))
        for start in range(0, len(wi), BATCH):
            rows = slice(start, start + BATCH)
            plain, _ = lobe_values(model, wi[rows], wo[rows])
            values[rows] = plain[:, lobes] @ weights
        return np.maximum(values, 0)

    return Tabulated(f, **(ANISOTROPIC if model.anisotropic() else ISOTROPIC))


def texture_mean(texture, default):
    """Mean of a texture (channels,), over its unit square where it varies.

    `default` for an attribute of a mesh: only its surface knows it.
    """
    import drjit as dr
    import mitsuba as mi

    if texture.class_name() == "MeshAttribute":
        return np.atleast_1d(default)
    n = TEXELS if texture.is_spatially_varying() else 1
    x = (np.arange(n) + 0.5) / n
    points = [(float(u), float(v)) for u in x for v in x]
    if not mi.variant().startswith("scalar"):
        points = [np.float32(points).T]
    values = []
    for uv in points:
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.uv = mi.Point2f(*uv)
        if mi.is_spectral:
            si.wavelengths = WAVELENGTHS
        value = np.array(dr.detach(texture.eval(si)), float)
        values.append(value.reshape(len(value), -1).mean(axis=1))
    return np.mean(values, axis=0)
