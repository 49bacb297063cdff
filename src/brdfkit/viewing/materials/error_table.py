"""The table of errors of a view's fits under each loss, with the noise of the measurement."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from brdfkit.fitting.compare import compare
from brdfkit.fitting.noise_floor import compute_noise_floor
from brdfkit.regression import losses
from brdfkit.viewing.application import Message

if TYPE_CHECKING:
    from brdfkit.viewing.materials.material_state import MaterialState

FLOOR = "noise"  # the name of the last row
SMALL = 1e-3  # an error of fewer digits


def make_error_table(states: MaterialState) -> Message:
    """Return the message "errors": rows of the fits, the best under the cbrt loss first.

    The least error of a column is marked. The last row is the error of a perfect model, if the
    noise of the measurement is known.
    """
    measured: Any = states.measured
    comparison = compare(measured, list(states.fits.values()))
    shown = comparison.shown
    table = np.array([[errors[loss] for loss in shown] for errors in comparison.errors.values()])
    least = np.nanmin(np.vstack([table, np.full(len(shown), np.inf)]), axis=0)
    rows = [
        _make_row(name, errors, (errors == least).tolist())
        for name, errors in zip(comparison.errors, table, strict=True)
    ]
    floor = compute_noise_floor(measured, shown)
    if floor:
        rows.append(_make_row(FLOOR, np.array([floor[loss] for loss in shown]), []))
    columns = [[loss, losses.named[loss].meaning] for loss in shown]
    return {"type": "errors", "columns": columns, "rows": rows}, []


def _make_row(name: str, errors: Any, best: list[bool]) -> dict[str, Any]:
    """Return a row of the table."""
    cells = [_format_error(float(error)) for error in errors]
    return {"name": name, "cells": cells, "best": best}


def _format_error(error: float) -> str:
    """Return an error as a short text; a small one with one digit."""
    return "-" if np.isnan(error) else f"{error:.3g}" if error >= SMALL else f"{error:.0e}"
