"""Describes the parameters of the fits for the report, as rows of a table and as JSON."""

import json
from collections.abc import Collection
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.colours import RGB
from brdfkit.core.json_values import round_numbers, to_json
from brdfkit.model.value_table import LARGEST_COUNT
from brdfkit.regression import Fit

DIGITS = 9  # for numbers in JSON: enough to make the model, and equal on every machine


def describe_fit(fit: Fit, known_notes: Collection[str] = ()) -> dict[str, Any]:
    """Return what the template shows of a fit, without notes that the report has already."""
    return {
        "title": fit.model.label(),
        "rows": [_describe_parameter(fit, name) for name in fit.values],
        "remarks": [*(note for note in fit.notes if note not in known_notes), fit.message],
        "warnings": fit.warnings,
        "json": json.dumps(round_numbers(_to_record(fit), DIGITS), indent=2, ensure_ascii=False),
        "samples": f"{fit.samples:,}",
        "evaluations": fit.evaluations,
        "loss": f"{fit.loss_label} {fit.loss:.5g}",
        "has_errors": any(np.isfinite(np.ravel(e)).any() for e in fit.standard_errors.values()),
    }


def _describe_parameter(fit: Fit, name: str) -> dict[str, Any]:
    """Return what the template shows of a parameter: meaning, numbers, standard errors, bounds."""
    declared = fit.model.parameters[name]
    values, errors = np.atleast_1d(fit.values[name]), np.atleast_1d(fit.standard_errors[name])
    low, high = declared.bounds
    bounds = f"{low:g} to {high:g}" if np.isfinite([low, high]).all() else f"from {low:g}"
    return {
        "name": name,
        "meaning": declared.meaning,
        "numbers": _format_numbers(values, errors),
        "channels": RGB if len(values) == 3 and not fit.wavelengths else (),
        "bounds": "any sign" if low == -np.inf else bounds,
        "at_bound": name in fit.at_bounds,
    }


def _format_numbers(values: AnyArray, errors: AnyArray) -> list[tuple[str, str]]:
    """Return values with their standard errors, or "", as text; of many, the extreme ones."""
    if len(values) > LARGEST_COUNT:
        chosen = [int(np.argmin(values)), int(np.argmax(values))]
        values, errors = values[chosen], errors[chosen]
    return [
        (_format(value, 5), _format(error, 2) if np.isfinite(error) else "")
        for value, error in zip(values, errors, strict=True)
    ]


def _format(value: float, digits: int) -> str:
    """Return a number as text with so many digits, and a short exponent."""
    return f"{value:.{digits}g}".replace("e-0", "e-")


def _to_record(fit: Fit) -> Any:
    """Return a fit for JSON, without its time, which differs each time."""
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
