"""Whether values fit a model better with phi_o turned by 180°: the highlight lies at the light."""

from dataclasses import replace

import numpy as np

from brdfkit.model import labels
from brdfkit.model.samples import Samples
from brdfkit.regression import losses, regress

MODEL, STARTS = "ggx", 2
# So many samples tell, and no more are needed
FEWEST, ENOUGH = 12, 1_000
# Degrees: beyond, few files are reliable
LARGEST = 85
TURN = np.array([-1.0, -1.0, 1.0])
# Where the correlation of logarithms with how far wo lies towards the mirror direction is larger,
# no fit is needed: of 37 files turned by 180°, those that are recognised have -0.1 or less
CLEAR = 0.1


def error_when_turned(samples: Samples) -> float:
    """The error of a model on `Samples` with phi_o turned by 180°, over that as they are.

    Above 1 for materials with a highlight, which lies in the mirror direction; from 0.35 for those
    of CUReT that are brightest towards the light; below 0.2 where the instrument counts phi_o from
    the mirror's side, unless noise hides it. NaN where too few samples tell, and where values
    clearly become larger towards the mirror direction.
    """
    samples = samples.at(samples.valid)
    if len(samples.wi) > ENOUGH:
        rows = np.random.default_rng(0).choice(len(samples.wi), ENOUGH, replace=False)
        samples = samples.at(rows)
    rows = samples.within(LARGEST)
    if rows.sum() < FEWEST or _forwards(samples.at(rows)) > CLEAR:
        return np.nan
    own, turned = (_error(s.at(rows)) for s in (samples, replace(samples, wo=samples.wo * TURN)))
    return turned / own if own > 0 else np.nan


def _forwards(samples):
    """How much larger values become towards the mirror direction: a correlation from -1 to 1."""
    values = samples.values.mean(axis=1)
    rows = values > 0
    towards = -(samples.wi[rows, :2] * samples.wo[rows, :2]).sum(axis=1)
    logs = np.log(values[rows])
    if not (len(logs) and logs.std() and towards.std()):
        return 0.0
    return float(np.corrcoef(logs, towards)[0, 1])


def _error(samples):
    """The error of the model by the mean of the channels."""
    grey = samples.values.mean(axis=1, keepdims=True)
    grey = Samples.from_arrays(samples.wi, samples.wo, grey, None, ("Y",), "grey")
    return regress(labels.model(MODEL), grey, losses.named["log"], starts=STARTS).loss
