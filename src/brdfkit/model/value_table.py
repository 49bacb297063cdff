"""The table of a model's values: a row for each parameter, with its errors where they are known."""

import math

import numpy as np

from brdfkit.core.documents import Cell, Table
from brdfkit.core.documents.parts import BAD

MOST = 3  # numbers of a weight that are shown; of more the least and the most


def make_value_table(model, errors=None, at_bounds=()):
    """The `Table` of a `Model` with values.

    `errors`: standard errors in the form of ``model.values``, NaN where there is none; `at_bounds`:
    the parameters that a fit left on a bound.
    """
    return Table(
        tuple(
            _make_row(model, name, value, errors[name] if errors else np.nan, name in at_bounds)
            for name, value in model.values.items()
        )
    )


def _make_row(model, name, value, error, is_on_bound):
    parameter = model.parameters[name]
    low, high = parameter.bounds
    within = f" ({low:g} to {high:g})" if math.isfinite(high) else ""
    colour = value if isinstance(value, tuple) and not model.wavelengths else ()
    numbers = _format_numbers(value, error, model.wavelengths)
    shown = Cell(numbers, colour=colour, place=None if colour else _find_place(value, parameter))
    note = Cell("on its bound", kind=BAD) if is_on_bound else ""
    return Cell(name, hint=parameter.meaning + within), shown, note


def _format_numbers(value, error, wavelengths):
    """The numbers of a parameter in words, with their standard errors."""
    values = np.atleast_1d(value)
    errors = np.broadcast_to(error, values.shape)
    if len(values) > MOST:
        return _summarise(values, errors, wavelengths)
    return "  ".join(map(_format_with_error, values, errors))


def _format_with_error(value, error):
    """A value with its standard error, if it has one."""
    return f"{value:.6g}" if np.isnan(error) else f"{value:.6g} ± {error:.2g}"


def _summarise(values, errors, wavelengths):
    """Many numbers as the least and the most of them."""
    least, most = (
        f"{values[k]:.4g} at {wavelengths[k]:g} nm" for k in (np.argmin(values), np.argmax(values))
    )
    known = errors[np.isfinite(errors)]
    error = f", ± {np.median(known):.2g} in the median" if len(known) else ""
    return f"{least} to {most}{error}"


def _find_place(value, parameter):
    """Where the value of a shape parameter lies between its bounds, 0 to 1; None of a weight."""
    if parameter.linear:
        return None
    low, high, at = (math.log(x) if parameter.log else x for x in (*parameter.bounds, value))
    return (at - low) / (high - low)
