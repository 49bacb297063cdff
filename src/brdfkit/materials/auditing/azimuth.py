"""Tests whether the azimuths phi_o of a measurement are off by 180°, as those of some instruments.

The highlight then lies towards the light, and a model fits the samples much better after phi_o is
turned by 180°.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.model import labels
from brdfkit.model.samples import Samples
from brdfkit.regression import losses, regress

MODEL, STARTS = "ggx", 2
FEWEST_SAMPLES, MOST_SAMPLES = 12, 1_000  # smallest and largest number of samples in the test
MAX_ANGLE = 85  # degrees; in many files, samples at larger angles to the normal are unreliable
TURN = np.array([-1.0, -1.0, 1.0])  # factors of x, y, z that turn a direction by 180° in azimuth
# If values correlate more than this with nearness to the mirror direction, the azimuths are right,
# and no model is fitted. Of 37 files with phi_o turned by 180°, all that the test recognises have a
# correlation of -0.1 or less
CLEAR_CORRELATION = 0.1


def compute_turned_error_ratio(samples: Samples) -> float:
    """Return a model's error on samples with phi_o turned by 180°, over its error on the originals.

    The ratio is above 1 for materials with a highlight in the mirror direction, and at least 0.35
    for CUReT's materials that are brightest towards the light. Where the azimuths of a measurement
    are off by 180°, it is below 0.2, unless noise hides this. It is NaN for too few samples, and
    where values clearly become larger towards the mirror direction.
    """
    samples = samples.at(samples.valid)
    if len(samples.wi) > MOST_SAMPLES:
        rows = np.random.default_rng(0).choice(len(samples.wi), MOST_SAMPLES, replace=False)
        samples = samples.at(rows)
    inside = samples.within(MAX_ANGLE)
    if (
        inside.sum() < FEWEST_SAMPLES
        or _compute_mirror_correlation(samples.at(inside)) > CLEAR_CORRELATION
    ):
        return np.nan
    turned = replace(samples, wo=samples.wo * TURN)
    error, turned_error = (_compute_model_error(s.at(inside)) for s in (samples, turned))
    return turned_error / error if error > 0 else np.nan


def _compute_mirror_correlation(samples: Samples) -> float:
    """Return how strongly values rise towards the mirror direction: a correlation, -1 to 1."""
    values = samples.values.mean(axis=1)
    rows = values > 0
    towards = -(samples.wi[rows, :2] * samples.wo[rows, :2]).sum(axis=1)
    logs = np.log(values[rows])
    if not (len(logs) and logs.std() and towards.std()):
        return 0.0
    return float(np.corrcoef(logs, towards)[0, 1])


def _compute_model_error(samples: Samples) -> float:
    """Fit the model to the samples' mean over the channels, and return the loss of the fit."""
    values = samples.values.mean(axis=1, keepdims=True)
    grey = Samples.from_arrays(samples.wi, samples.wo, values, None, ("Y",), "grey")
    model: Any = labels.model(MODEL)
    return regress(model, grey, losses.named["log"], starts=STARTS).loss
