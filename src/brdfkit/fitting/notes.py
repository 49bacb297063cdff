"""What one should know of a fit, in sentences."""

from brdfkit.core.names import format_percent
from brdfkit.fitting.lobe_notes import list_lobe_notes
from brdfkit.fitting.uncertainty.isotropic_limit import note_on_azimuth
from brdfkit.materials.auditing.data_findings import list_data_findings
from brdfkit.model.evaluation import compute_clamped_share
from brdfkit.regression import Picture


def list_notes(data, samples, loss, found, fitted, weighted):
    """Notes on a fit, in words: what is doubtful in the data, too few measured numbers, negative
    values, a clamped model, an isotropic one of an anisotropic material; `weighted`: whether the
    user gave weights."""
    notes = [*list_data_findings(data, samples.largest_angle)]
    if weighted:
        notes.append("samples count by the weights that were given; so in the loss")
    if isinstance(loss, Picture):
        notes.append(f"seen: {loss.describe()}; pixels tell no standard errors")
    known, sought = found.certainty.numbers, found.certainty.parameters
    if known < sought:
        notes.append(
            f"{known} numbers were measured for {sought} that are sought: other values fit as well"
        )
    if len(samples.wi) > 1 and fitted.shapes() and _are_equal(samples.values):
        notes.append("all measured values are equal: they tell nothing of a highlight's shape")
    negative = (samples.values < 0).mean()
    if negative and not loss.linear:
        notes.append(f"{format_percent(100 * negative)} of the {_explain_negative(data)}")
    if fitted.has_signed_weights():
        clamped = compute_clamped_share(fitted)
        notes.append(f"{clamped:.1%} of the hemisphere's direction pairs are clamped at 0")
    if data.anisotropic and (note := note_on_azimuth(data, samples, loss, fitted)):
        notes.append(note)
    notes += list_lobe_notes(data, samples, fitted, found.at_bounds)
    return (*notes, *found.certainty.undetermined, *found.certainty.trades)


def _are_equal(values):
    """Whether all rows are equal; most often the first two tell."""
    return bool((values[0] == values[1]).all() and (values == values[0]).all())


def _explain_negative(data):
    """The end of a note in words: which values are negative, and what this does to the fit."""
    if (data.values[data.samples.valid] >= 0).all():
        return (
            "values in linear sRGB are negative and count as 0, though none was measured so: these "
            "colours are more saturated than sRGB holds, and the fit shows them less so"
        )
    return "measured values are negative and count as 0"
