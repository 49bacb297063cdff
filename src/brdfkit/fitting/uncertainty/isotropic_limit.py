"""Estimates the least error that any isotropic model can have on an anisotropic material.

A note of a fit reports this error if an isotropic model was fitted to such a material.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.geometry.directions import rotate_z
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import differentiate
from brdfkit.core.jit.threads import in_turn
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.model.samples.samples import Samples
from brdfkit.regression import Loss, Picture

PAIRS = 2_000  # largest number of direction pairs at which azimuths are compared
TURNS = 8  # number of angles by which the surface is turned for each direction pair


def is_isotropic(model: Model, wi: FloatArray, wo: FloatArray) -> bool:
    """Return whether a model's values at direction pairs (n, 3) do not change with azimuth."""
    values = model.eval(wi, wo)
    turned = [model.eval(rotate_z(wi, angle), rotate_z(wo, angle)) for angle in (0.7, 1.9)]
    largest_change = max(abs(other - values).max() for other in turned)
    return bool(largest_change <= 1e-9 * abs(values).max())


def note_on_isotropic_model(
    data: Measured, samples: Samples, loss: Loss | Picture, fitted: Model
) -> str | None:
    """Return a note if an isotropic model was fitted to an anisotropic material, otherwise None.

    If the data can be evaluated at all azimuths, as a table can, the note gives the least error
    that any isotropic model can reach, which follows from the spread over the azimuths.
    """
    rows = np.linspace(0, len(samples.wi) - 1, min(PAIRS, len(samples.wi))).astype(int)
    part = samples.at(rows)
    if not is_isotropic(fitted, part.wi, part.wo):
        return None
    note = "the material changes as the surface turns, and the model as fitted does not"
    if isinstance(loss, Picture) or not (data.is_table or data.has_lookup):
        return note  # the error of a picture cannot be computed at single azimuths
    least = _compute_isotropic_limit(data if fitted.wavelengths else data.rgb, part, loss)
    return f"{note}: no isotropic one has an error below about {least:.2g}"


@in_turn
def _compute_isotropic_limit(data: Measured, samples: Samples, loss: Loss) -> float:
    """Return the least error E that an isotropic model can have on samples and their turned copies.

    An isotropic model has one value for all azimuths of a direction pair. Its best value is found
    by one Gauss-Newton step from the mean. The step is exact if the loss's difference is linear in
    the model's value, or if it is h(model) - h(measured) for some function h.
    """
    angles = np.arange(TURNS) * 2 * np.pi / TURNS
    measured = np.stack(
        [data.eval(rotate_z(samples.wi, a), rotate_z(samples.wo, a)) for a in angles]
    )
    cosines = [double_precision.to_array(np.tile(w[:, 2], TURNS)) for w in (samples.wi, samples.wo)]
    squares: Any = 0.0
    for channel in np.moveaxis(measured, 2, 0):
        values = double_precision.to_array(channel.ravel())

        def difference(value: JitFloat, values: JitFloat = values) -> JitFloat:
            return loss.difference(value, values, *cosines)

        start = double_precision.to_array(np.tile(channel.mean(axis=0), TURNS))
        d, slope = (np.array(x).reshape(channel.shape) for x in differentiate(difference, start))
        gain = (d * slope).sum(axis=0) ** 2 / np.maximum((slope**2).sum(axis=0), 1e-300)
        squares = squares + ((d**2).sum(axis=0) - gain) / TURNS
    return math.sqrt(loss.importance(samples) @ squares)
