"""Writes the notes of a fit: sentences on doubtful data and doubtful parameters."""

from __future__ import annotations

import numpy as np

from brdfkit.core.names import format_percent
from brdfkit.fitting.lobe_notes import list_lobe_notes
from brdfkit.fitting.uncertainty.isotropic_limit import note_on_isotropic_model
from brdfkit.materials.auditing.data_findings import list_data_findings
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.model.evaluation import compute_clamped_share
from brdfkit.model.samples import Samples
from brdfkit.model.samples.measures import compute_measure, integrate_measure
from brdfkit.regression import Loss, Picture
from brdfkit.regression.certainty import Certainty
from brdfkit.regression.refitting import COMPLETED
from brdfkit.regression.regression import Solution


def list_fit_notes(
    data: Measured,
    samples: Samples,
    loss: Loss | Picture,
    solution: Solution,
    fitted: Model,
    weighted: bool,
) -> tuple[str, ...]:
    """Return notes, as sentences, on doubtful data and doubtful parameters of a fit.

    They concern, for example, defects of the data, too few measured numbers, negative values, a
    model that is clamped at 0, and an isotropic model of an anisotropic material. `solution` is the
    result of the search, `fitted` the model with its values, and `weighted` whether the user gave
    weights.
    """
    notes = [*list_data_findings(data, samples.largest_angle)]
    if data.evidence is not None:
        made = data.info.get("completed", "from values").split(" with ")[0]
        notes.append(f"{COMPLETED} {made}: its cells tell no standard errors of the parameters")
    if weighted:
        notes.append("samples count by the weights that were given; so in the loss")
    if isinstance(loss, Picture):
        notes.append(f"seen: {loss.describe()}; pixels tell no standard errors")
    known, sought = solution.certainty.numbers, solution.certainty.parameters
    if known < sought:
        notes.append(
            f"{known} numbers were measured for {sought} that are sought: other values fit as well"
        )
    values = samples.values
    if len(values) > 1 and fitted.shapes() and (values == values[0]).all():
        notes.append("all measured values are equal: they tell nothing of a highlight's shape")
    negative = (values < 0).mean()
    if negative and not loss.linear:
        notes.append(f"{format_percent(100 * negative)} of the {_explain_negative_values(data)}")
    if fitted.has_signed_weights():
        clamped = compute_clamped_share(fitted)
        notes.append(f"{clamped:.1%} of the hemisphere's direction pairs are clamped at 0")
    if data.anisotropic and (note := note_on_isotropic_model(data, samples, loss, fitted)):
        notes.append(note)
    notes += list_lobe_notes(data, samples, fitted, solution.at_bounds)
    return (*notes, *solution.certainty.undetermined, *solution.certainty.trades)


def find_certainty(data: Measured, samples: Samples, solution: Solution) -> Certainty:
    """Return how certain the parameters of a fit are; of a completed table, no standard errors."""
    certainty = solution.certainty
    if data.evidence is None:
        return certainty
    return certainty.without_standard_errors(samples.values.size)


def _explain_negative_values(data: Measured) -> str:
    """Return a clause on the cause of negative values in `data` and on their effect on the fit."""
    if (data.values[data.samples.valid] >= 0).all():
        return (
            "values in linear sRGB are negative and count as 0, though none was measured so: these "
            "colours are more saturated than sRGB holds, and the fit shows them less so"
        )
    return "measured values are negative and count as 0"


def measure_sample_coverage(
    loss: Loss | Picture, samples: Samples, max_angle: float
) -> dict[str, float]:
    """Return the values of `Fit.effective_samples` and `Fit.unrepresented`, by these names.

    The first is the number of samples with equal weights that would be as informative; the second
    is the share of directions up to `max_angle` [degrees] without samples. A fit to a `Picture` has
    neither.
    """
    if isinstance(loss, Picture):
        return {}
    weights = loss.importance(samples)
    shares, covered = compute_measure(samples.extents, loss.measure), 1.0
    if isinstance(shares, np.ndarray):
        covered = float(shares.sum()) / integrate_measure(float(max_angle), loss.measure)
    return {
        "effective_samples": float(weights.sum() ** 2 / (weights @ weights)),
        "unrepresented": max(1 - covered, 0.0),
    }
