"""Fits with the standard errors of a measurement, in which noisy samples count less.

A model differs from a measured value for two reasons: noise, with the standard error σ that the
measurement states, and the model's own error τ, which is assumed equal for all samples. Both are in
units of the loss's differences. The best weight of a sample is then 1 / (τ² + σ²)
[DerSimonian & Laird 1986]: all samples count alike where the noise is smaller than the model's
error, and by 1 / σ² where it is larger.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import differentiate
from brdfkit.model import Model
from brdfkit.model.samples import Samples
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.regression import Solution, regress

# The smallest τ², as a share of the mean σ², because a σ of 0 cannot be trusted
SMALLEST_MODEL_ERROR = 0.01
# The start of the note on such a fit, by which it can be recognised
BY_ERRORS = "samples count by their standard errors"
# Weights within this share of each other are equal
EQUAL_WEIGHTS = 0.05


def regress_with_noise(model: type[Model], samples: Samples, loss: Any, **how: Any) -> Solution:
    """Return the `Solution` of `regress`, with `Samples` weighted by their standard errors.

    `how`: the other arguments of `regress`.
    """
    solution = regress(model, samples, loss, **how)
    shares = compute_noise_weights(samples, loss, solution.eval(model, samples), solution.loss)
    if shares.min() > (1 - EQUAL_WEIGHTS) * shares.max():
        return solution
    solution = regress(model, replace(samples, weight=samples.weight * shares), loss, **how)
    least = shares.min() / shares.max()
    note = f"{BY_ERRORS}, the noisiest {least:.0%}; so in the loss"
    return replace(solution, notes=(*solution.notes, note))


def compute_noise_weights(
    samples: Samples, loss: Loss, values: FloatArray, error: float
) -> FloatArray:
    """Return the weights τ² / (τ² + σ²) of the samples (n,).

    `values` (n, channels): the model's, from a first fit; `error`: E, the loss of this fit.
    """
    errors: Any = samples.errors
    variances = [
        _compute_variances(samples, loss, *channel)
        for channel in zip(values.T, samples.values.T, errors.T, strict=True)
    ]
    variance = sum(variances, np.zeros(len(values)))
    mean = loss.importance(samples) @ variance
    # In the units of E², which is a mean over the channels
    variance /= values.shape[1] if loss.channel_mean else 1
    tau2 = max(error**2 - mean, SMALLEST_MODEL_ERROR * mean)
    return tau2 / (tau2 + variance) if tau2 else np.ones(len(values))


def _compute_variances(
    samples: Samples, loss: Loss, model: FloatArray, measured: FloatArray, sigma: FloatArray
) -> FloatArray:
    """Return the variances (n,) of a channel's differences, at the values `model` (n,)."""
    cos_i, cos_o = (double_precision.to_array(w[:, 2]) for w in (samples.wi, samples.wo))
    measured = double_precision.to_array(measured)

    def difference(value: JitFloat) -> JitFloat:
        return loss.difference(value, measured, cos_i, cos_o)

    _, slope = differentiate(difference, double_precision.to_array(model))
    # A σ of 0 means that no spread was seen, as without rays; the smallest other σ replaces it
    known = sigma[sigma > 0]
    return (np.array(slope) * np.maximum(sigma, known.min() if len(known) else 0)) ** 2
