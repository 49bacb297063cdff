"""Fits a model to a measurement with known standard errors, so that noisy samples count less.

A model differs from a measured value for two reasons: noise, whose standard error σ the measurement
states, and the model's own error τ, which is assumed to be equal for all samples. Both are in units
of the loss's differences. The best weight of a sample is then 1 / (τ² + σ²) [DerSimonian & Laird
1986]. Where the noise is smaller than the model's error, all samples have nearly equal weights;
where it is larger, weights are nearly 1 / σ².
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import differentiate
from brdfkit.model import Model
from brdfkit.model.samples import Samples
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.regression import Solution, regress

# Least squared error of the model, as a share of the mean squared standard error of the samples, so
# that samples with a standard error of 0 do not rule the fit
SMALLEST_MODEL_ERROR = 0.01
# Start of the note on a fit that weights samples by their standard errors; `Fit` recognises it so
BY_ERRORS = "samples count by their standard errors"
# If all weights of samples differ by less than this share, the fit with equal weights is kept
EQUAL_WEIGHTS = 0.05


def regress_with_noise(model: type[Model], samples: Samples, loss: Any, **how: Any) -> Solution:
    """Return the `Solution` of `regress` with samples weighted by their standard errors.

    A first fit, with equal weights, shows how large the model's own error is. `how`: the other
    arguments of `regress`.
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
    """Return the weights τ² / (τ² + σ²) of the samples (n,), smaller for noisier samples.

    σ is the standard error of a sample, and τ the model's own error, both in units of the loss.
    `values` (n, channels): BRDF of the model after a first fit; `error`: loss E of this fit.
    """
    errors: Any = samples.errors
    variances = [
        _compute_variances(samples, loss, *channel)
        for channel in zip(values.T, samples.values.T, errors.T, strict=True)
    ]
    variance = sum(variances, np.zeros(len(values)))
    mean = loss.importance(samples) @ variance
    # E² is a mean over the channels, so the variance of a sample has to be a mean over them, too
    variance /= values.shape[1] if loss.channel_mean else 1
    tau2 = max(error**2 - mean, SMALLEST_MODEL_ERROR * mean)
    return tau2 / (tau2 + variance) if tau2 else np.ones(len(values))


def _compute_variances(
    samples: Samples, loss: Loss, model: FloatArray, measured: FloatArray, sigma: FloatArray
) -> FloatArray:
    """Return the variances (n,) that noise causes in the loss's differences, in one channel.

    `model`, `measured` (n,): values of the BRDF; `sigma` (n,): standard errors of the measured
    ones.
    """
    cos_i, cos_o = (double_precision.to_array(w[:, 2]) for w in (samples.wi, samples.wo))
    measured = double_precision.to_array(measured)

    _, slope = differentiate(
        lambda value: loss.difference(value, measured, cos_i, cos_o),
        double_precision.to_array(model),
    )
    # A standard error of 0 only means that a few repeated measurements happened to agree; it is
    # replaced by the smallest other one
    known = sigma[sigma > 0]
    return (np.array(slope) * np.maximum(sigma, known.min() if len(known) else 0)) ** 2
