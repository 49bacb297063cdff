"""Samples a sum of lobes with signed weights, clamped at 0, by a table of half vectors.

A single lobe cannot be sampled if its weight may be negative. So the sum is tabulated, with each
parameter at the mean of its texture, and again whenever a parameter changes.
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, MitsubaObject
from brdfkit.mitsuba_bridge.bsdf.half_vector_table import HalfVectorTable, integrate_shares
from brdfkit.model import Model
from brdfkit.model.evaluation import compute_lobe_values

# The tables are coarse, since the models with signed weights are smooth polynomials
ISOTROPIC: dict[str, Any] = {"azimuths": 1, "angles": 32, "cells": (24, 20), "points": 2}
ANISOTROPIC: dict[str, Any] = {"azimuths": 12, "angles": 16, "cells": (24, 20), "points": 1}
BATCH = 8192  # number of direction pairs evaluated at once, since a model may have a thousand lobes
# The number of points along each side, and the wavelengths [nm], over which a texture is averaged
TEXELS = 8
WAVELENGTHS = (450.0, 520.0, 590.0, 650.0)


def tabulate_lobe_sum(model: Model, weights: AnyArray, lobes: list[int]) -> HalfVectorTable:
    """Return a table of the sum of some lobes of a model, clamped at 0, to draw directions from.

    `model` gives the shape parameters. `weights` (lobes of the model, channels) has a row for every
    lobe of the model, and `lobes` are the indices of the lobes in the sum.
    """
    weights = weights[lobes]

    def evaluate_sum(wi: AnyArray, wo: AnyArray) -> AnyArray:
        values = np.empty((len(wi), weights.shape[1]))
        for start in range(0, len(wi), BATCH):
            rows = slice(start, start + BATCH)
            plain, _ = compute_lobe_values(model, wi[rows], wo[rows])
            values[rows] = plain[:, lobes] @ weights
        return np.maximum(values, 0)

    size = ANISOTROPIC if model.is_anisotropic() else ISOTROPIC
    return HalfVectorTable(integrate_shares(evaluate_sum, **size))


def average_texture(texture: MitsubaObject, default: ArrayLike) -> AnyArray:
    """Return the mean (channels,) of a texture over the unit square.

    It is `default` for a mesh attribute, whose values only the mesh has.
    """
    import drjit as dr
    import mitsuba as mi

    if texture.class_name() == "MeshAttribute":
        return np.atleast_1d(default)
    n = TEXELS if texture.is_spatially_varying() else 1
    x = (np.arange(n) + 0.5) / n
    points: list[Any] = [(float(u), float(v)) for u in x for v in x]
    if not str(mi.variant()).startswith("scalar"):
        points = [np.array(points, np.float32).T]
    values = []
    for uv in points:
        si: Any = dr.zeros(mi.SurfaceInteraction3f)
        si.uv = mi.Point2f(*uv)
        if mi.is_spectral:
            si.wavelengths = WAVELENGTHS
        value = np.array(dr.detach(texture.eval(si)), float)
        values.append(value.reshape(len(value), -1).mean(axis=1))
    return np.mean(values, axis=0)
