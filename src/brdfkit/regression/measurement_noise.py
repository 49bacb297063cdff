"""Fits that use the standard errors of a measurement: a sample counts by how noisy it is.

A model differs from the measured value by noise, of the standard error σ that the measurement
states, and because it is wrong, by τ, alike everywhere, in the loss's differences. The best weight
is then 1 / (τ² + σ²) [DerSimonian & Laird 1986]: where noise is less than the model is wrong, all
samples count alike, whatever their σ; where it is more, by 1 / σ².
"""

from dataclasses import replace

import numpy as np

from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import differentiate
from brdfkit.regression.regression import regress

# The least τ², as a share of the mean σ²: a σ of 0 is not trusted beyond it
LEAST = 0.01
# How the note begins that says it, by which a fit is known again
BY_ERRORS = "samples count by their standard errors"
# Weights within this share of each other are alike
ALIKE = 0.05


def regress_noisy(model, samples, loss, **how):
    """The `Solution` of `regress` on `Samples` that have standard errors, which it uses."""
    found = regress(model, samples, loss, **how)
    shares = find_shares(samples, loss, found.eval(model, samples), found.loss)
    if shares.min() > (1 - ALIKE) * shares.max():
        return found
    found = regress(model, replace(samples, weight=samples.weight * shares), loss, **how)
    least = shares.min() / shares.max()
    note = f"{BY_ERRORS}, the noisiest {least:.0%}; so in the loss"
    return replace(found, notes=(*found.notes, note))


def find_shares(samples, loss, values, error):
    """τ² / (τ² + σ²) of each sample (n,), where a fit gave the model's `values` (n, channels) and
    the `error` E of the `loss`."""
    variance = sum(
        _variance(samples, loss, *channel)
        for channel in zip(values.T, samples.values.T, samples.errors.T, strict=True)
    )
    mean = loss.importance(samples) @ variance
    # As E² has them, of which they are a part
    variance /= values.shape[1] if loss.channel_mean else 1
    tau2 = max(error**2 - mean, LEAST * mean)
    return tau2 / (tau2 + variance) if tau2 else np.ones(len(values))


def _variance(samples, loss, model, measured, sigma):
    """The variances (n,) of a channel's differences, at the `model`'s values (n,)."""
    cos_i, cos_o = (double_precision.to_array(w[:, 2]) for w in (samples.wi, samples.wo))
    measured = double_precision.to_array(measured)

    def difference(value):
        return loss.difference(value, measured, cos_i, cos_o)

    _, slope = differentiate(difference, double_precision.to_array(model))
    # No spread was seen, as where no ray came: σ is not 0, but as the least known
    known = sigma[sigma > 0]
    return (np.array(slope) * np.maximum(sigma, known.min() if len(known) else 0)) ** 2
