"""The tables of a sweep: errors by material and model, in words; all rows as CSV or Parquet."""

import csv
import json
import math
from collections import Counter
from dataclasses import fields
from statistics import median

from brdfkit.documents.text import MARK
from brdfkit.errors import BrdfkitError
from brdfkit.files import write_safely
from brdfkit.fitting.albedo_cells import mean_albedos
from brdfkit.measured.albedos import ANGLES
from brdfkit.verbs.compare import format_error


def errors(sweep):
    """The names of the columns, a row of texts for each material, and rows on all of them.

    A column of numbers has a name that begins with ">"; an error is marked where the light of the
    fit is wrong.
    """
    rows = by_material(sweep)
    models = list(dict.fromkeys(row.model for row in sweep.rows))
    best = {material: fit.name for material, fit in sweep.best.items()}
    body = [
        (material, *(_cell(found.get(model)) for model in models), best.get(material, ""))
        for material, found in rows.items()
    ]
    wins = Counter(best.values())
    foot = [
        ("median", *(format_error(m) for m in medians(sweep, models)), ""),
        ("times best, by the samples fitted", *(str(wins[model]) for model in models), ""),
    ]
    if sweep.warned:
        wrong = Counter(row.model for row in sweep.warned)
        foot.append((f"{MARK}light is wrong", *(str(wrong[model]) for model in models), ""))
    columns = "material", *(f">{model}" for model in models), "best"
    return columns, body, foot if len(rows) > 1 else []


def by_material(sweep):
    """The rows of a sweep by material and by model."""
    found = {}
    for row in sweep.rows:
        found.setdefault(row.material, {})[row.model] = row
    return found


def medians(sweep, models):
    """The median error of each model over the materials to which it was fitted."""
    for model in models:
        found = [row.error for row in sweep.rows if row.model == model and row.fit]
        yield median(found) if found else math.nan


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


def _cell(row):
    """The error of a row in words, marked where its light is wrong; nothing for a fit that did not
    come about."""
    if row is None:
        return ""
    if not row.fit:
        return "failed"
    return (MARK if row.fit.warnings else "") + format_error(row.error)
