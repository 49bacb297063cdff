"""The parameters of the fits as rows and as JSON."""

import json

import numpy as np

from brdfkit.core.colours import RGB
from brdfkit.core.json_values import round_numbers, to_json
from brdfkit.model.value_table import MOST

DIGITS = 9  # of numbers in JSON: enough to build the model, and the same on every machine


def describe(fit, told=()):
    """What the page says of a fit, as plain data, but for the notes that it has `told` already."""
    return {
        "title": fit.model.label(),
        "rows": [_row(fit, name) for name in fit.values],
        "remarks": [*(note for note in fit.notes if note not in told), fit.message],
        "warnings": fit.warnings,
        "json": json.dumps(round_numbers(_record(fit), DIGITS), indent=2, ensure_ascii=False),
        "samples": f"{fit.samples:,}",
        "evaluations": fit.evaluations,
        "loss": f"{fit.loss_label} {fit.loss:.5g}",
        "has_errors": any(np.isfinite(np.ravel(e)).any() for e in fit.standard_errors.values()),
    }


def _row(fit, name):
    """A parameter: its numbers, their standard errors, and what one should know of it."""
    declared = fit.model.parameters[name]
    values, errors = np.atleast_1d(fit.values[name]), np.atleast_1d(fit.standard_errors[name])
    low, high = declared.bounds
    bounds = f"{low:g} to {high:g}" if np.isfinite([low, high]).all() else f"from {low:g}"
    return {
        "name": name,
        "meaning": declared.meaning,
        "numbers": _numbers(values, errors),
        "channels": RGB if len(values) == 3 and not fit.wavelengths else (),
        "bounds": "any sign" if low == -np.inf else bounds,
        "at_bound": name in fit.at_bounds,
    }


def _numbers(values, errors):
    """(value, standard error or nothing) as texts; of many numbers the least and the most."""
    if len(values) > MOST:
        chosen = [int(np.argmin(values)), int(np.argmax(values))]
        values, errors = values[chosen], errors[chosen]
    return [
        (_short(value, 5), _short(error, 2) if np.isfinite(error) else "")
        for value, error in zip(values, errors, strict=True)
    ]


def _short(value, digits):
    return f"{value:.{digits}g}".replace("e-0", "e-")


def _record(fit):
    """The fit for JSON; without its time, which is another one each time."""
    return to_json(
        {
            "model": fit.model.label(),
            "material": fit.data,
            "parameters": fit.model.arguments,
            "standard_errors": fit.standard_errors,
            "at_bounds": fit.at_bounds,
            "loss": fit.loss_name,
            "loss_label": fit.loss_label,
            "error": fit.loss,
            "samples": fit.samples,
            "settings": fit.settings,
            "checksum": fit.checksum,
        }
    )
