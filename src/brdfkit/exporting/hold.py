"""Finds what a target draws of a material: the material itself, or the nearest that it holds."""

from __future__ import annotations

from dataclasses import replace

from brdfkit.core.errors import BrdfkitError
from brdfkit.exporting.loss import Loss, measure_loss
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
    model = thing.rgb
    if target.spectral:
        changes: tuple[str, ...] = ()
        held = target.hold(thing.model if isinstance(thing, Fit) else thing)
    else:
        changes = _list_changes_of_colour(thing)
        held = target.hold(model)
    if held is None:
        held, loss = refit(model, target)
        label = held.drawn.name
        changes = (*changes, f"{model.label()} refitted as {label}")
    else:
        loss = measure_loss(model, held.drawn)
    return replace(held, changes=(*changes, *held.changes)), loss


def _list_changes_of_colour(thing: Fit | Model) -> tuple[str, ...]:
    """Return in words what the conversion of a spectral model to linear sRGB drops."""
    count = len(thing.wavelengths)
    return (f"{count} wavelengths became linear sRGB",) if count else ()


def refit(model: Model, target: Target) -> tuple[Held, Loss]:
    """Return what a target draws that is nearest to a model, of the forms that it holds.

    The target's candidates are fitted to the model's values at the cells of a table; the one whose
    ball looks most alike is taken.
    """
    data = sample_on_grid(model)
    best: tuple[Held, Loss] | None = None
    for label in target.candidates:
        held = target.hold(fit(data, label, loss=LOSS).rgb)
        if held is None:
            raise BrdfkitError(f"{target.name} cannot hold its own candidate {label}.")
        loss = measure_loss(model, held.drawn)
        if best is None or loss.delta_e < best[1].delta_e:
            best = held, loss
    assert best is not None, "every target has a candidate"
    return best


def sample_on_grid(model: Model) -> Measured:
    """Return the values of a model at the cells of a small table."""
    return evaluate_on_grid(model, TABLE_SHAPES)


def list_held_models(target: Target) -> list[str]:
    """Return the labels of those models and sums, of all that `rank` compares, that a target holds.

    A model counts if the target holds it with its default values, without changes.
    """
    held = {label: target.hold(labels.model(label)()) for label in list_default_models()}
    return [label for label, one in held.items() if one and not one.changes]
