"""Describes the parameters of fits for a report, as rows of a table and as JSON."""

import json
from collections.abc import Collection
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.colours import RGB
from brdfkit.core.json_values import round_numbers, to_json
from brdfkit.model.value_table import LARGEST_COUNT
from brdfkit.regression import Fit

# Digits of numbers in JSON: enough to make the model again, and equal on every machine
DIGITS = 9


def describe_fit(fit: Fit, known_notes: Collection[str] = ()) -> dict[str, Any]:
    """Return the description of a fit for the template: parameters, remarks, and JSON to copy.

    `known_notes`: notes that another part of the report shows, so that they are left out.
    """
    return {
        "title": fit.model.label(),
        "rows": [_describe_parameter(fit, name) for name in fit.values],
        "remarks": [*(note for note in fit.notes if note not in known_notes), fit.message],
        "warnings": fit.warnings,
        "json": json.dumps(
            round_numbers(_make_json_record(fit), DIGITS), indent=2, ensure_ascii=False
        ),
        "samples": f"{fit.samples:,}",
        "evaluations": fit.evaluations,
        "loss": f"{fit.loss_label} {fit.loss:.5g}",
        "has_errors": any(np.isfinite(np.ravel(e)).any() for e in fit.standard_errors.values()),
    }


def _describe_parameter(fit: Fit, name: str) -> dict[str, Any]:
    """Return a parameter's row for the template: meaning, values, standard errors, bounds."""
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
    """Return pairs of texts, a value and its standard error, which is "" if unknown.

    Of many values, as a spectrum has, only the smallest and the largest are returned.
    """
    if len(values) > LARGEST_COUNT:
        chosen = [int(np.argmin(values)), int(np.argmax(values))]
        values, errors = values[chosen], errors[chosen]
    return [
        (_format_number(value, 5), _format_number(error, 2) if np.isfinite(error) else "")
        for value, error in zip(values, errors, strict=True)
    ]


def _format_number(value: float, digits: int) -> str:
    """Return a number as text with this many `digits` and a short exponent, as 1e-5."""
    return f"{value:.{digits}g}".replace("e-0", "e-")


def _make_json_record(fit: Fit) -> Any:
    """Return a fit as data for JSON, without its time, which would differ in each report."""
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
