"""Finds what a target draws of a material: the material itself, or the nearest that it holds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import FloatArray
from brdfkit.core.colours import compute_rgb_weights
from brdfkit.core.errors import BrdfkitError
from brdfkit.exporting.loss import Drawable, Loss, compare_balls, measure_loss
from brdfkit.exporting.target import Held, Target
from brdfkit.fitting.fit import fit
from brdfkit.fitting.ranking.ranking import list_default_models
from brdfkit.materials.converting import evaluate_on_grid
from brdfkit.materials.measured import Measured
from brdfkit.model import Model, labels
from brdfkit.regression import Fit

# Cells of the tables, of isotropic and anisotropic materials, to whose values forms are fitted.
# More cells make the fits ten times slower, and no better
TABLE_SHAPES = (45, 23, 18), (12, 30, 15, 9)
LOSS = "picture"  # a ball is what the loss of an export is told by


def hold(thing: Fit | Model, target: Target) -> tuple[Held, Loss]:
    """Return what a target draws of a fit or a model, and how far it is from it."""
    own, model = thing.model if isinstance(thing, Fit) else thing, thing.rgb
    reference: Drawable = model
    if own.wavelengths:
        reference = _InColours(own)
    changes: tuple[str, ...] = ()
    if own.wavelengths and not target.spectral:
        changes = (f"{len(own.wavelengths)} wavelengths became linear sRGB",)
    held = target.hold(own if target.spectral else model)
    if held is None:
        held = refit(model, target)
        changes = (*changes, f"{model.label()} refitted as {held.drawn.name}")
    return replace(held, changes=(*changes, *held.changes)), measure_loss(reference, held.drawn)


@dataclass(frozen=True)
class _InColours:
    """A spectral model whose values are the colours of its spectra in linear sRGB.

    The property `rgb` of models clips colours of weights outside sRGB; these are as they are.
    """

    model: Model

    @property
    def name(self) -> str:
        """The name of the model."""
        return self.model.name

    def eval(self, wi: FloatArray, wo: FloatArray) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, 3) for directions to light and viewer, (n, 3) each."""
        weights = compute_rgb_weights(self.model.wavelengths, self.name)
        return np.asarray(self.model.eval(wi, wo) @ weights, float)


def refit(model: Model, target: Target) -> Held:
    """Return what a target draws that is nearest to a model, of the forms that it holds.

    The target's candidates are fitted to the model's values at the cells of a table; the one whose
    ball looks most alike is taken.
    """
    data = sample_on_grid(model)
    tried = []
    for label in target.candidates:
        held = target.hold(fit(data, label, loss=LOSS).rgb)
        if held is None:
            raise BrdfkitError(f"{target.name} cannot hold its own candidate {label}.")
        tried.append(held)
    return min(tried, key=lambda held: compare_balls(model, held.drawn))


def sample_on_grid(model: Model) -> Measured:
    """Return the values of a model at the cells of a small table."""
    return evaluate_on_grid(model, TABLE_SHAPES)


def list_held_models(target: Target) -> list[str]:
    """Return the labels of models and sums to rank for a target.

    These are all that `rank` compares and the target holds, which a table does, too; then the forms
    that other materials are refitted as.
    """
    known = list_default_models()
    if target.any_form:
        return known
    held = [label for label in known if target.hold(labels.model(label)()) is not None]
    return [*held, *(label for label in target.candidates if label not in held)]
