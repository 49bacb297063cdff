"""Makes the table that shows the values of a model, a row per parameter, with known errors."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike
from brdfkit.core.documents import Cell, Table
from brdfkit.core.documents.parts import BAD, Row
from brdfkit.model.parameters import Parameter

LARGEST_COUNT = 3  # a weight with more numbers than this is shown by its range


def make_value_table(
    model: Any, errors: Mapping[str, Any] | None = None, at_bounds: Collection[str] = ()
) -> Table:
    """Make the table of a model's parameters: name, value with its error, and a note.

    `errors` are standard errors in the form of ``model.values``, NaN where unknown. `at_bounds` are
    the names of parameters that a fit left on a bound, which the note says.
    """
    return Table(
        tuple(
            _make_row(model, name, value, errors[name] if errors else np.nan, name in at_bounds)
            for name, value in model.values.items()
        )
    )


def _make_row(model: Any, name: str, value: Any, error: ArrayLike, is_on_bound: bool) -> Row:
    """Make the table's row of a parameter: its name, its value with the error, and a note."""
    parameter = model.parameters[name]
    low, high = parameter.bounds
    within = f" ({low:g} to {high:g})" if math.isfinite(high) else ""
    colour = value if isinstance(value, tuple) and not model.wavelengths else ()
    numbers = _format_numbers(value, error, model.wavelengths)
    shown = Cell(
        numbers, colour=colour, place=None if colour else _locate_between_bounds(value, parameter)
    )
    note = Cell("on its bound", kind=BAD) if is_on_bound else ""
    return Cell(name, hint=parameter.meaning + within), shown, note


def _format_numbers(value: Any, error: ArrayLike, wavelengths: Sequence[float]) -> str:
    """Format the numbers of a parameter with their standard errors, or the range of many."""
    values = np.atleast_1d(value)
    errors = np.broadcast_to(error, values.shape)
    if len(values) > LARGEST_COUNT:
        return _format_range(values, errors, wavelengths)
    return "  ".join(map(_format_with_error, values, errors))


def _format_with_error(value: float, error: float) -> str:
    """Format a number with its standard error, such as "0.5 ± 0.01", if the error is known."""
    return f"{value:.6g}" if np.isnan(error) else f"{value:.6g} ± {error:.2g}"


def _format_range(values: AnyArray, errors: AnyArray, wavelengths: Sequence[float]) -> str:
    """Format many numbers of a spectrum as the smallest and the largest, with wavelengths."""
    least, most = (
        f"{values[k]:.4g} at {wavelengths[k]:g} nm"
        for k in map(int, (np.argmin(values), np.argmax(values)))
    )
    known = errors[np.isfinite(errors)]
    error = f", ± {np.median(known):.2g} in the median" if len(known) else ""
    return f"{least} to {most}{error}"


def _locate_between_bounds(value: float, parameter: Parameter) -> float | None:
    """Return the place of a shape parameter between its bounds, 0 to 1; None for a weight."""
    if parameter.linear:
        return None
    low, high, at = (math.log(x) if parameter.log else x for x in (*parameter.bounds, value))
    return (at - low) / (high - low)
