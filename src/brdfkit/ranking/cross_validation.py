"""Cross-validation: a model fitted to all folds but one, and held to that one, each in its turn."""

import time
from dataclasses import dataclass

import numpy as np

from brdfkit.fitting import regress
from brdfkit.fitting.loss import squares

# Starts of the fits without a fold: they begin where the fit of all samples ended
STARTS = 2


@dataclass(frozen=True, eq=False)
class Validated:
    """A model's fit to all samples, and its squared errors where it did not see them.

    `errors` (blocks,): of each block, in the units of E², which is their sum; `parameters`: how
    many were sought; `bic`: of the fit to all samples; `seconds`: that it took.
    """

    errors: np.ndarray
    parameters: int
    bic: float
    seconds: float


def cross_validate(model, held_out, anisotropic, seed, report):
    """The `Validated` of a model class on `HeldOut` samples; `report`: called with how many fits
    are done."""
    samples, loss = held_out.samples, held_out.loss
    how = {"anisotropic": anisotropic, "seed": seed}
    report(0)
    began = time.perf_counter()
    whole = regress(model, samples, loss, **how)
    seconds = time.perf_counter() - began
    report(1)

    found = np.empty(len(samples.wi))
    for fold in range(held_out.folds.max() + 1):
        out = held_out.folds == fold
        part = regress(model, samples.at(~out), loss, starts=STARTS, first=whole.shapes, **how)
        seen = samples.at(out)
        found[out] = squares(loss, part.eval(model, seen), seen)
        report(2 + fold)
    certainty = whole.certainty
    bic = certainty.bic(whole.loss)
    return Validated(held_out.sum_by_block(found), certainty.parameters, bic, seconds)
