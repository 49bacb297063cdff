"""Writes the HTML page of a sweep, with tables of errors, the failures and all fits."""

import math
import os
from collections.abc import Sequence, Sized
from pathlib import Path
from typing import Any
from urllib.parse import quote

from brdfkit.core.names import join_words
from brdfkit.core.pages.page import write_page
from brdfkit.core.version import __version__
from brdfkit.fitting.sweeping import tables
from brdfkit.materials.measured.albedos import ANGLES
from brdfkit.regression import losses
from brdfkit.regression.albedo import WRONG_FACTOR
from brdfkit.regression.albedo_cells import (
    average_albedos_over_channels,
    format_albedo,
    is_wrong_albedo,
)

TINT_STEPS = 10  # number of shades that the style sheet defines for cells
COLOURLESS_RATIO = 4.0  # a cell whose error is this multiple of the best one has no colour
ALBEDOS = (
    f"Under {join_words([f'{angle:g}°' for angle in ANGLES])}: the albedo of the fit, the share of "
    "the light from that angle to the normal that it reflects, the mean over the channels; below "
    "it that of the measurement."
)
EMPTY_CELL = {"text": "", "kind": "", "hint": "", "link": ""}
EXPLANATIONS = {
    "held_out": "The error of fits by the loss alone, in directions that they were not fitted to: "
    "all in turn, a fifth at a time.",
    "psnr": "The peak signal-to-noise ratio of a ball's picture beside the measurement's, under "
    "several lights, as a screen shows it: the more the better.",
}


def write_sweep_page(sweep: Any, path: str | Path) -> None:
    """Write the page of a `Sweep` to the file `path`."""
    path = Path(path)
    materials = tables.group_by_material(sweep)
    models = list(dict.fromkeys(row.model for row in sweep.rows))
    write_page(
        "sweep.html",
        path,
        title=f"{_format_count(models, 'model')} fitted to {_format_count(materials, 'material')}",
        summary=sweep.summary,
        comparisons=[
            _make_table_of_quantity(sweep, materials, models, quantity, path.parent)
            for quantity in tables.list_quantities(sweep)
        ],
        problems=sweep.problems,
        fits=_make_table_of_fits(sweep),
        albedos=ALBEDOS,
        version=__version__,
    )


def _make_table_of_quantity(
    sweep: Any, materials: Any, models: Sequence[str], quantity: Any, folder: Path
) -> dict[str, Any]:
    """Return the table of a quantity, by materials and models, for the page's template.

    Links to saved fits are relative to `folder`.
    """
    columns, texts, foot = tables.compare_models(sweep, quantity)
    rows = []
    for (material, by_model), row in zip(materials.items(), texts, strict=True):
        best = quantity.find_best_row(by_model.values())
        cells = [_make_fit_cell(by_model.get(model), best, quantity, folder) for model in models]
        file = next(iter(by_model.values())).file
        rows.append({"material": material, "file": file, "cells": cells, "best": row[-1]})
    explanation = EXPLANATIONS.get(quantity.name) or _explain_table_of_errors(sweep)
    return {
        "title": quantity.title,
        "explanation": explanation,
        "columns": columns,
        "rows": rows,
        "foot": foot,
    }


def _explain_table_of_errors(sweep: Any) -> str:
    """Return sentences on the loss, on the marks in the table of errors, and on its limits."""
    loss = losses.named[sweep.rows[0].loss]
    judge = (
        "; fit --judge, or sweep(..., judge=True), adds errors in directions held out, and pictures"
    )
    marks = (
        " Marked are fits whose light is wrong: they reflect more than arrives, or differ by more "
        f"than a factor of {WRONG_FACTOR:g} from the measured albedo."
    )
    return (
        f"Loss {loss.name}: {loss.meaning}. The best of a row is bold, the others have the more "
        "colour the nearer they come to it; colours compare within a row only. Errors are by the "
        "very samples that the models were fitted to, and the more numbers a model has, the more "
        f"they flatter it{'' if len(tables.list_quantities(sweep)) > 1 else judge}."
        f"{marks if sweep.warned else ''}"
    )


def _make_fit_cell(row: Any, best: Any, quantity: Any, folder: Path) -> dict[str, str]:
    """Return the text, style, hint and link of the cell of one fit, for the page's template.

    `best` is the best fit to the same material; the link is relative to `folder`.
    """
    if row is None:
        return EMPTY_CELL
    if not row.fit:
        return EMPTY_CELL | {"text": "failed", "kind": "failed", "hint": row.message}
    number = quantity.read_number(row)
    if math.isnan(number):
        return EMPTY_CELL | {"text": "–"}
    ratio = math.log(quantity.compute_error_ratio(row, best)) / math.log(COLOURLESS_RATIO)
    kind = f"near near-{round(TINT_STEPS * max(0.0, 1 - ratio))}"
    kind += " best" if number == quantity.read_number(best) else ""
    link = quote(Path(os.path.relpath(row.saved, folder)).as_posix()) if row.saved else ""
    return {
        "text": quantity.format(number),
        "kind": f"{kind} bad" if row.fit.warnings else kind,
        "hint": "; ".join([f"{number:.9g}", *row.fit.warnings]),
        "link": link,
    }


def _make_table_of_fits(sweep: Any) -> dict[str, Any] | None:
    """Return the table of all fits for the page's template; None if there are no fits."""
    if not sweep.fits:
        return None
    quantities = tables.list_quantities(sweep)
    rows = []
    for row in (row for row in sweep.rows if row.fit):
        bounds = [f"on a bound: {', '.join(row.at_bounds)}"] if row.at_bounds else []
        rows.append(
            {
                "material": row.material,
                "model": row.model,
                "quantities": [
                    quantity.format(quantity.read_number(row)) for quantity in quantities
                ],
                "albedos": [
                    (format_albedo(own), format_albedo(measured), is_wrong_albedo(own, measured))
                    for own, measured in zip(
                        *average_albedos_over_channels(row.fit.albedo), strict=True
                    )
                ],
                "numbers": [row.parameters, f"{row.samples:,}", f"{row.seconds:.2f}"],
                "remarks": "; ".join([*bounds, *row.fit.notes, row.message]),
                "values": {name: _format_parameter_value(v) for name, v in row.fit.values.items()},
            }
        )
    heads = ["error", *(quantity.head for quantity in quantities[1:])]
    numbers = [*heads, *(f"{angle:g}°" for angle in ANGLES), "parameters", "samples", "time [s]"]
    columns = ["material", "model", *(f">{name}" for name in numbers), "remarks", ""]
    return {"columns": columns, "rows": rows}


def _format_parameter_value(value: float | tuple[float, ...]) -> str:
    """Return the value of a parameter, one number or several, as text."""
    return "  ".join(f"{v:.5g}" for v in (value if isinstance(value, tuple) else [value]))


def _format_count(things: Sized, noun: str) -> str:
    """Return the number of `things` with their noun in the right form, such as "2 models"."""
    return f"{len(things)} {noun}{'' if len(things) == 1 else 's'}"
