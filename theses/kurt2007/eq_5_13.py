"""E of eq. 5.13, of a model as it is: its sum is not clamped at 0, as the thesis does not."""

import numpy as np

from brdfkit.model.evaluation import lobe_values, weight_matrix
from brdfkit.regression.losses.named import losses


def error(model, samples):
    """E of a model with values at `Samples`, squares summed over the channels."""
    plain, squared = lobe_values(model, samples.wi, samples.wo)
    weights = weight_matrix(model)
    return error_of(plain @ weights + squared @ weights**2, samples)


def error_of(values, samples):
    """E of values (n, channels) of a BRDF."""
    squares = ((values - samples.values) * samples.wi[:, 2:]) ** 2
    return float(np.sqrt(losses["kurt"].importance(samples) @ squares.sum(axis=1)))
