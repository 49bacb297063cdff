"""Errors of a BRDF against a measured material."""

import math

import numpy as np

from brdfkit.fitting.loss import losses
from brdfkit.fitting.selection import selected
from brdfkit.model import double_precision


def error(thing, data, loss, max_angle=80.0):
    """E of the loss named `loss` between `thing` (anything with `.eval`) and a `Measured`.

    Over the samples with both angles below `max_angle` [degrees]; its units: `brdfkit.losses`.
    nan where the loss weighs none of them, as the cosine loss at normal incidence.

    >>> error(models()["lambert"](), load("paint.binary"), "log")    # doctest: +SKIP
    """
    loss = losses[loss]
    samples = selected(data, max_angle)
    cosines, weights = loss.geometry(samples)
    measured = loss.target(samples.values)
    values = np.broadcast_to(thing.eval(samples.wi, samples.wo), measured.shape)
    squares = np.square(_transformed(loss, values, cosines) - _transformed(loss, measured, cosines))
    total = weights @ squares.sum(axis=1)
    normaliser = loss.normaliser(weights, measured.shape[1])
    return math.sqrt(total / normaliser) if normaliser else math.nan


def _transformed(loss, values, cosines):
    Float64 = double_precision.float64()
    columns = [loss.g(Float64(np.ascontiguousarray(v * cosines))) for v in values.T]
    return np.stack([np.asarray(c) for c in columns], axis=1)
