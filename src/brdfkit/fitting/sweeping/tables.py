"""Makes the tables of a sweep: errors by material and model as text, all rows as CSV or Parquet."""

import csv
import json
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from statistics import median
from typing import Any

from brdfkit.core.documents.text import BAD_MARK
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import write_safely
from brdfkit.fitting.compare import format_error
from brdfkit.materials.measured.albedos import ANGLES
from brdfkit.regression.albedo_cells import average_albedos_over_channels


@dataclass(frozen=True)
class Quantity:
    """A number, such as the error, by which the tables of a sweep compare models.

    `name`: its attribute in `Row`.
    `title`, `head`: title of its table, and head of its column in the list of all fits.
    `by`: end of the line "times best, by ...", such as "pictures".
    `format`: function that converts the number to text.
    `decibels`: whether it is in dB, so that more is better.
    """

    name: str
    title: str
    head: str
    by: str
    format: Callable[[float], str]
    decibels: bool = False

    def read_number(self, row: Any) -> float:
        """Return the number of a `Row`; nan if its fit failed."""
        return float(getattr(row, self.name)) if row.fit else math.nan

    def find_best_row(self, rows: Iterable[Any]) -> Any:
        """Return the `Row` with the best number; None if no row has a number."""
        numbers = [row for row in rows if not math.isnan(self.read_number(row))]
        return (max if self.decibels else min)(numbers, key=self.read_number, default=None)

    def compute_error_ratio(self, row: Any, best: Any) -> float:
        """Return the error of a `row` divided by the error of the `best` row.

        A number in decibels is converted to an error first.
        """
        one, least = self.read_number(row), self.read_number(best)
        if self.decibels:
            return 10 ** ((least - one) / 20)
        return one / least if least else math.inf if one else 1.0


ERROR = Quantity("error", "Errors of the fits", "error", "the samples fitted", format_error)
HELD_OUT = Quantity(
    "held_out", "Errors where they were not fitted", "held out", "errors held out", format_error
)
PSNR = Quantity(
    "psnr", "PSNR of their pictures [dB]", "PSNR [dB]", "pictures", "{:.1f}".format, decibels=True
)


def list_quantities(sweep: Any) -> list[Quantity]:
    """Return the quantities of a `Sweep`: the error, and held-out error and PSNR if computed."""
    judged = [
        q for q in (HELD_OUT, PSNR) if any(not math.isnan(q.read_number(row)) for row in sweep.rows)
    ]
    return [ERROR, *judged]


def compare_models(
    sweep: Any, quantity: Quantity = ERROR
) -> tuple[tuple[str, ...], list[tuple[str, ...]], list[tuple[str, ...]]]:
    """Compare the models of a `Sweep` by a quantity, as the texts of a table.

    Return the names of the columns, a row for each material, and rows with medians and counts below
    them. The name of a column of numbers begins with ">"; a mark precedes numbers of fits with
    wrong albedos.
    """
    rows = group_by_material(sweep)
    models = list(dict.fromkeys(row.model for row in sweep.rows))
    best = {
        material: quantity.find_best_row(by_model.values()) for material, by_model in rows.items()
    }
    names = {material: row.fit.name if row else "" for material, row in best.items()}
    body = [
        (
            material,
            *(_format_quantity_cell(by_model.get(model), quantity) for model in models),
            names[material],
        )
        for material, by_model in rows.items()
    ]
    wins = Counter(names.values())
    foot: list[tuple[str, ...]] = [
        (
            "median",
            *(quantity.format(m) for m in _compute_medians_by_model(sweep, models, quantity)),
            "",
        ),
        (f"times best, by {quantity.by}", *(str(wins[model]) for model in models), ""),
    ]
    if sweep.warned:
        wrong = Counter(row.model for row in sweep.warned)
        foot.append((f"{BAD_MARK}light is wrong", *(str(wrong[model]) for model in models), ""))
    columns = "material", *(f">{model}" for model in models), "best"
    return columns, body, foot if len(rows) > 1 else []


def group_by_material(sweep: Any) -> dict[str, dict[str, Any]]:
    """Return the rows of a `Sweep` by material, then by model."""
    rows: dict[str, dict[str, Any]] = {}
    for row in sweep.rows:
        rows.setdefault(row.material, {})[row.model] = row
    return rows


def _compute_medians_by_model(
    sweep: Any, models: Sequence[str], quantity: Quantity
) -> Iterator[float]:
    """Yield the median of a quantity over all materials for each model; nan without fits."""
    for model in models:
        numbers = [quantity.read_number(row) for row in sweep.rows if row.model == model]
        numbers = [number for number in numbers if not math.isnan(number)]
        yield median(numbers) if numbers else math.nan


def write_csv(sweep: Any, path: str | Path) -> None:
    """Write all rows as comma-separated values; characters that are invalid in UTF-8 become "?"."""
    columns = _make_table_columns(sweep)
    with (
        write_safely(path) as beside,
        beside.open("w", encoding="utf-8", errors="replace", newline="") as stream,
    ):
        writer = csv.writer(stream)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))


def write_parquet(sweep: Any, path: str | Path) -> None:
    """Write all rows as an Apache Parquet table."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise BrdfkitError(
            f"{path}: for Parquet the package pyarrow is missing; 'pip install pyarrow' brings it, "
            "or write a .csv."
        ) from None
    with write_safely(path) as beside:
        parquet.write_table(pyarrow.table(_make_table_columns(sweep)), beside)


def _make_table_columns(sweep: Any) -> dict[str, list[Any]]:
    """Return the values of each column by its name; None stands for nan."""
    records = [_make_table_record(row) for row in sweep.rows]
    return {name: [record[name] for record in records] for name in records[0]}


def _make_table_record(row: Any) -> dict[str, Any]:
    """Return the values of one row by the names of their columns; None stands for nan."""
    record = {f.name: getattr(row, f.name) for f in fields(row) if f.name not in ("fit", "saved")}
    record["at_bounds"] = " ".join(row.at_bounds)
    record["values"] = json.dumps(row.fit.values) if row.fit else None
    means = average_albedos_over_channels(row.fit.albedo if row.fit else None)
    for name, albedos in zip(("albedo", "measured_albedo"), means, strict=True):
        record |= {f"{name}_{angle:g}": a for angle, a in zip(ANGLES, albedos, strict=True)}
    record["warnings"] = "; ".join(row.fit.warnings) if row.fit else None
    return {name: None if value != value else value for name, value in record.items()}


def _format_quantity_cell(row: Any, quantity: Quantity) -> str:
    """Return the number of a `Row` as text, marked if its albedo is wrong; "" without a row."""
    if row is None:
        return ""
    if not row.fit:
        return "failed"
    return (BAD_MARK if row.fit.warnings else "") + quantity.format(quantity.read_number(row))
