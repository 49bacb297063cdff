"""Cross-validates a model: fits it to all folds but one, and computes its error on that one."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.fitting.ranking.appearance import Appearance
from brdfkit.fitting.ranking.held_out import HeldOut
from brdfkit.model import Model
from brdfkit.model.evaluation import make_model
from brdfkit.regression.albedo import Albedo, TargetAlbedo

# Number of starts of each fit without one fold; the first start is the result of the fit to all
# samples
STARTS = 2


@dataclass(frozen=True, eq=False)
class Validated:
    """The result of cross-validating a model: its held-out errors, and its fit to all samples.

    `errors`: squared errors (blocks,) of held-out blocks of directions; their sum is E².
    `albedo`, `picture`, `doubt`: properties of the fit to all samples, as in `Ranked`.
    `parameters`: number of searched parameters.
    `bic`: Bayesian information criterion of the fit to all samples.
    `seconds`: wall-clock time of that fit.
    """

    errors: FloatArray
    albedo: Albedo
    picture: float
    doubt: str
    parameters: int
    bic: float
    seconds: float


def cross_validate(
    model: type[Model],
    held_out: HeldOut,
    appearance: Appearance,
    target: TargetAlbedo,
    anisotropic: bool | None,
    seed: int,
    report: Callable[[int], object],
) -> Validated:
    """Cross-validate a model class; `report` is called with the number of finished fits.

    The fit to all samples should keep the albedos `target` of the material; `appearance` judges its
    picture and its colour at grazing angles.
    """
    settings = {"anisotropic": anisotropic, "seed": seed}
    report(0)
    began = time.perf_counter()
    whole = held_out.regress(model, held_out.folds >= 0, target_albedo=target, **settings)
    seconds = time.perf_counter() - began
    report(1)

    errors = compute_held_out_errors(
        model, held_out, whole.shapes, settings, lambda done: report(1 + done)
    )
    brdf, certainty = make_model(model, whole.shapes, whole.weights).eval, whole.certainty
    albedo = target.compare_with_fit(brdf)
    return Validated(
        errors,
        albedo,
        appearance.compute_picture_error(brdf),
        appearance.find_implausibility(brdf) or next(iter(albedo.warnings()), ""),
        certainty.parameters,
        certainty.compute_bic(whole.loss),
        seconds,
    )


def compute_held_out_errors(
    model: type[Model],
    held_out: HeldOut,
    first: Mapping[str, Any],
    settings: dict[str, Any],
    report: Callable[[int], object] = lambda done: None,
) -> FloatArray:
    """Return the squared errors (blocks,) of a model in blocks of directions held out of each fit.

    Their sum is E². The fits begin at the shape parameters `first`, with `settings` of `regress`;
    `report` is called with the number of finished fits.
    """
    errors = np.empty(len(held_out.folds))
    for fold in range(held_out.folds.max() + 1):
        out = held_out.folds == fold
        part = held_out.regress(model, ~out, starts=STARTS, first=first, **settings)
        errors[out] = held_out.compute_squared_differences(model, part, out)
        report(1 + fold)
    return held_out.sum_by_block(errors)
