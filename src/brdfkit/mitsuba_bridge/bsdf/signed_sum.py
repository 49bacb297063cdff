"""Samples a sum of lobes with signed weights, clamped at 0, by a table of half vectors.

A single lobe cannot be sampled where its weight may be negative. So the sum is tabulated whenever a
parameter changes, with the mean of each texture.
"""

import numpy as np

from brdfkit.mitsuba_bridge.bsdf.half_vector_table import HalfVectorTable
from brdfkit.model.evaluation import compute_lobe_values

# Coarse tables: the models with signed weights are smooth polynomials
ISOTROPIC = {"azimuths": 1, "angles": 32, "cells": (24, 20), "points": 2}
ANISOTROPIC = {"azimuths": 12, "angles": 16, "cells": (24, 20), "points": 1}
BATCH = 8192  # directions at once: a model may have a thousand lobes
# A texture is averaged over as many points along each side, and over these wavelengths [nm]
TEXELS = 8
WAVELENGTHS = (450.0, 520.0, 590.0, 650.0)


def tabulate(model, weights, lobes):
    """The `HalfVectorTable` of a sum of lobes, clamped at 0.

    `model`: with its shape parameters; `weights`: (all its lobes, channels); `lobes`: the indices
    of the lobes in the sum.
    """
    weights = weights[lobes]

    def f(wi, wo):
        values = np.empty((len(wi), weights.shape[1]))
        for start in range(0, len(wi), BATCH):
            rows = slice(start, start + BATCH)
            plain, _ = compute_lobe_values(model, wi[rows], wo[rows])
            values[rows] = plain[:, lobes] @ weights
        return np.maximum(values, 0)

    return HalfVectorTable(f, **(ANISOTROPIC if model.is_anisotropic() else ISOTROPIC))


def average_texture(texture, default):
    """The mean (channels,) of a texture over the unit square.

    It is `default` for a mesh attribute, whose values only the mesh has.
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
