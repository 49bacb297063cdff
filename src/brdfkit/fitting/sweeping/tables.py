"""The tables of a sweep: quantities by material and model, in words; all rows as CSV or Parquet."""

import csv
import json
import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, fields
from statistics import median

from brdfkit.core.documents.text import BAD_MARK
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import write_safely
from brdfkit.fitting.compare import format_error
from brdfkit.materials.measured.albedos import ANGLES
from brdfkit.regression.albedo_cells import mean_albedos


@dataclass(frozen=True)
class Quantity:
    """A number of each fit that tells models apart: `name`: of the attribute of a `Row`.

    `title`: above its table; `head`: of a column; `by`: what "times best" counts by; `format`: a
    number as text; `decibels`: whether it is in dB, and more is better.
    """

    name: str
    title: str
    head: str
    by: str
    format: Callable[[float], str]
    decibels: bool = False

    def of(self, row):
        """The number of a `Row`; nan where it has none."""
        return getattr(row, self.name) if row.fit else math.nan

    def best(self, rows):
        """The row of the best number, None where no row has one."""
        numbers = [row for row in rows if not math.isnan(self.of(row))]
        return (max if self.decibels else min)(numbers, key=self.of, default=None)

    def ratio(self, row, best):
        """How many times the error of the `best` row that of a `row` is."""
        one, least = self.of(row), self.of(best)
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


def quantities(sweep):
    """The quantities that the rows of a sweep have: the error, and those that it judged."""
    judged = [q for q in (HELD_OUT, PSNR) if any(not math.isnan(q.of(row)) for row in sweep.rows)]
    return [ERROR, *judged]


def compare(sweep, quantity=ERROR):
    """The names of the columns, a row of texts for each material, and rows on all of them, by a
    quantity.

    A column of numbers has a name that begins with ">"; a number is marked where the light of the
    fit is wrong.
    """
    rows = by_material(sweep)
    models = list(dict.fromkeys(row.model for row in sweep.rows))
    best = {material: quantity.best(found.values()) for material, found in rows.items()}
    best = {material: row.fit.name if row else "" for material, row in best.items()}
    body = [
        (material, *(_cell(found.get(model), quantity) for model in models), best[material])
        for material, found in rows.items()
    ]
    wins = Counter(best.values())
    foot = [
        ("median", *(quantity.format(m) for m in _medians(sweep, models, quantity)), ""),
        (f"times best, by {quantity.by}", *(str(wins[model]) for model in models), ""),
    ]
    if sweep.warned:
        wrong = Counter(row.model for row in sweep.warned)
        foot.append((f"{BAD_MARK}light is wrong", *(str(wrong[model]) for model in models), ""))
    columns = "material", *(f">{model}" for model in models), "best"
    return columns, body, foot if len(rows) > 1 else []


def by_material(sweep):
    """The rows of a sweep by material and by model."""
    found = {}
    for row in sweep.rows:
        found.setdefault(row.material, {})[row.model] = row
    return found


def _medians(sweep, models, quantity):
    """The median of a quantity of each model over the materials to which it was fitted."""
    for model in models:
        numbers = [quantity.of(row) for row in sweep.rows if row.model == model]
        numbers = [number for number in numbers if not math.isnan(number)]
        yield median(numbers) if numbers else math.nan


def write_csv(sweep, path):
    """Write all rows as comma-separated values; bytes of names that are no UTF-8 become "?"."""
    columns, how = _columns(sweep), {"encoding": "utf-8", "errors": "replace", "newline": ""}
    with write_safely(path) as beside, beside.open("w", **how) as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))


def write_parquet(sweep, path):
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
        parquet.write_table(pyarrow.table(_columns(sweep)), beside)


def _columns(sweep):
    """The rows as a list of numbers or texts for each column, by its name; None where it is nan."""
    records = [_record(row) for row in sweep.rows]
    return {name: [record[name] for record in records] for name in records[0]}


def _record(row):
    record = {f.name: getattr(row, f.name) for f in fields(row) if f.name not in ("fit", "saved")}
    record["at_bounds"] = " ".join(row.at_bounds)
    record["values"] = json.dumps(row.fit.values) if row.fit else None
    for name, albedos in zip(("albedo", "measured_albedo"), _albedos(row), strict=True):
        record |= {f"{name}_{angle:g}": a for angle, a in zip(ANGLES, albedos, strict=True)}
    record["warnings"] = "; ".join(row.fit.warnings) if row.fit else None
    return {name: None if value != value else value for name, value in record.items()}


def _albedos(row):
    """The mean albedos of the fit of a row and of its data; nan where they are not known."""
    return mean_albedos(row.fit.albedo if row.fit else None)


def _cell(row, quantity):
    """A number of a row in words, marked where its light is wrong; nothing for a fit that did not
    come about."""
    if row is None:
        return ""
    if not row.fit:
        return "failed"
    return (BAD_MARK if row.fit.warnings else "") + quantity.format(quantity.of(row))
