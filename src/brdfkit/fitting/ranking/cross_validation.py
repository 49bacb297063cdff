"""Cross-validation: a model fitted to all folds but one, and held to that one, each in its turn."""

import time
from dataclasses import dataclass

import numpy as np

from brdfkit.model.evaluation import make_model
from brdfkit.regression.light import Albedo

# Starts of the fits without a fold: they begin where the fit of all samples ended
STARTS = 2


@dataclass(frozen=True, eq=False)
class Validated:
    """A model's fit to all samples, and its squared errors where it did not see them.

    `errors` (blocks,): of each block, in the units of E², which is their sum; of the fit to all
    samples, `albedo`, `picture` and `doubt`: as in `Ranked`; `parameters`: how many were sought;
    `bic`: its criterion; `seconds`: that it took.
    """

    errors: np.ndarray
    albedo: Albedo
    picture: float
    doubt: str
    parameters: int
    bic: float
    seconds: float


def cross_validate(model, held_out, appearance, light, anisotropic, seed, report):
    """The `Validated` of a model class on what is `HeldOut`, by the material's `Appearance` and its
    `Light`, which the fit to all samples keeps; `report`: called with how many fits are done."""
    how = {"anisotropic": anisotropic, "seed": seed}
    report(0)
    began = time.perf_counter()
    whole = held_out.regress(model, held_out.folds >= 0, light=light, **how)
    seconds = time.perf_counter() - began
    report(1)

    errors = errors_held_out(model, held_out, whole.shapes, how, lambda done: report(1 + done))
    brdf, certainty = make_model(model, whole.shapes, whole.weights).eval, whole.certainty
    albedo = light.judge(brdf)
    return Validated(
        errors,
        albedo,
        appearance.picture_error(brdf),
        appearance.find_doubt(brdf) or next(iter(albedo.warnings()), ""),
        certainty.parameters,
        certainty.bic(whole.loss),
        seconds,
    )


def errors_held_out(model, held_out, first, how, report=lambda done: None):
    """The squared errors (blocks,) of a model class where it was not fitted, in the units of E².

    `first`: the shape parameters at which the fits begin; `how`: settings of `regress`; `report`:
    called with how many of the fits are done.
    """
    errors = np.empty(len(held_out.folds))
    for fold in range(held_out.folds.max() + 1):
        out = held_out.folds == fold
        part = held_out.regress(model, ~out, starts=STARTS, first=first, **how)
        errors[out] = held_out.squares(model, part, out)
        report(1 + fold)
    return held_out.sum_by_block(errors)
