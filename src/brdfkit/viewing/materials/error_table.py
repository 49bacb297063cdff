"""The table of errors of a view's pins and fits under each loss, with the noise and a verdict."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from brdfkit.core.names import join_words
from brdfkit.fitting.compare import choose_losses_to_show
from brdfkit.model import Model
from brdfkit.regression.losses.named_losses import DEFAULT, named
from brdfkit.viewing.application import Message
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials import pins

if TYPE_CHECKING:
    from brdfkit.viewing.materials.block_errors import BlockErrors
    from brdfkit.viewing.materials.material_state import MaterialState

FLOOR = "noise"  # the name of the last row
SMALL = 1e-3  # an error of fewer digits
FAR = 100.0  # times the noise, beyond which the factor is not said
EQUAL = 1.005  # a factor between errors that is not worth a word


@dataclass(frozen=True)
class Row:
    """A row of the table: a model, its name, and the name of its pin or ""."""

    name: str
    model: Model
    pin: str = ""
    colour: str = ""


def list_rows(states: MaterialState, state: State) -> list[Row]:
    """Return a row for each pin, and for each fit that is not pinned."""
    rows = [
        Row(pin["model"], pins.make_model(states, pin), pins.name_pin(pin), pins.find_colour(pin))
        for pin in state["pins"]
    ]
    shown, named_so = [row.model for row in rows], {row.name for row in rows}
    fits = [(label, fit.rgb) for label, fit in list(states.fits.items()) if fit.rgb not in shown]
    others = [Row(f"{n}, not pinned" if n in named_so else n, model) for n, model in fits]
    return [*rows, *others]


def describe_errors(states: MaterialState, state: State) -> Iterator[list[Message]]:
    """Yield progress while errors are computed, one model at a time, and then the table."""
    errors, rows = states.errors, list_rows(states, state)
    busy: dict[str, Any] = {"type": "busy", "task": "errors", "text": "Computing errors …"}
    end: list[Message] = []
    new = [row.model for row in rows if row.model not in errors.kept]
    for number, model in enumerate(new):
        yield [(busy | {"fraction": number / len(new) or None}, [])]
        errors.compute(model)
        end = [(busy | {"text": "", "fraction": None}, [])]
    yield [make_error_table(errors, rows, state["fit.loss"]), *end]


def make_error_table(errors: BlockErrors, rows: Sequence[Row], loss: str) -> Message:
    """Return the message "errors": rows of the models, the best under a loss first.

    The least error of a column is marked. The last row is the error of a perfect model, if the
    noise of the measurement is known. `verdict` says in words which model is the best.
    """
    loss = loss if loss in named.by_sample else DEFAULT
    known = {row: errors.errors(row.model) for row in rows}
    ordered = sorted(rows, key=lambda row: known[row][loss])
    usual = choose_losses_to_show(loss)
    errors_by_loss = {name: [own[name] for own in known.values()] for name in named.by_sample}
    least = {name: min(values, default=np.nan) for name, values in errors_by_loss.items()}
    described = [
        _make_row(row.name, known[row], least)
        | {"pin": row.pin, "colour": row.colour, "note": _note(errors, row, ordered[0], loss)}
        for row in ordered
    ]
    floor = [_make_row(FLOOR, errors.floor, {})] if rows and errors.floor else []
    columns = [[name, own.meaning, name in usual] for name, own in named.by_sample.items()]
    return {
        "type": "errors",
        "loss": loss,
        "columns": columns,
        "rows": [*described, *floor],
        "verdict": write_verdict(errors, ordered, loss),
    }, []


def write_csv(states: MaterialState, state: State) -> str:
    """Return the table as comma-separated values, with the names and units of a spreadsheet."""
    content = make_error_table(states.errors, list_rows(states, state), state["fit.loss"])[0]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["model", "pin", *(name for name, *_ in content["columns"]), "note"])
    for row in content["rows"]:
        number = row.get("pin", "").removeprefix(pins.PIN)
        values = ["" if value is None else f"{value:.6g}" for value in row["values"]]
        writer.writerow([row["name"], number, *values, row.get("note", "noise of the measurement")])
    return text.getvalue()


def _note(errors: BlockErrors, row: Row, best: Row, loss: str) -> str:
    """Return what is to be said of a row: that it is the best, or as good as it."""
    if row is best:
        return "best"
    return "not distinguishable from the best" if _are_tied(errors, row, best, loss) else ""


def _are_tied(errors: BlockErrors, row: Row, best: Row, loss: str) -> bool:
    """Return whether a row is as good as the best one, within the noise."""
    return errors.are_tied(row.model, best.model, loss)


def _make_row(name: str, own: Mapping[str, float], least: Mapping[str, float]) -> dict[str, Any]:
    """Return a row of the table, with a cell for every loss."""
    values = {loss: own.get(loss, np.nan) for loss in named.by_sample}
    return {
        "name": name,
        "cells": [format_error(value) for value in values.values()],
        "values": [value if np.isfinite(value) else None for value in values.values()],
        "best": [value == least.get(loss) for loss, value in values.items()],
    }


def format_error(error: float) -> str:
    """Return an error as a short text; a small one with one digit."""
    return "-" if np.isnan(error) else f"{error:.3g}" if error >= SMALL else f"{error:.0e}"


def write_verdict(errors: BlockErrors, ordered: Sequence[Row], loss: str) -> str:
    """Return sentences on which row is the best under a loss, and by how much.

    `ordered` are the rows, the best under the loss first.
    """
    if not ordered:
        return ""
    best, own = ordered[0], errors.errors(ordered[0].model)
    if len(ordered) == 1:
        return _compare_with_noise(errors, own[loss], loss)
    tied = [row for row in ordered[1:] if _are_tied(errors, row, best, loss)]
    second = errors.errors(ordered[1].model)[loss]
    if tied:
        names = join_words([_call(row) for row in tied])
        text = (
            f"{_call(best)} and {names} are not distinguishable by {loss}: they differ by less "
            "than noise."
        )
    else:
        share = 1 - own[loss] / second
        text = (
            f"{_call(best)} is best by {loss}: its error {format_error(own[loss])} is "
            f"{100 * share:.0f} % below that of {_call(ordered[1])}, the next."
        )
        part, where = errors.locate_difference(ordered[1].model, best.model, loss)
        text += f" {100 * part:.0f} % of the difference lies {where}."
    return " ".join([text, *_name_other_leaders(errors, ordered, loss)])


def _name_other_leaders(errors: BlockErrors, ordered: Sequence[Row], loss: str) -> list[str]:
    """Return a sentence for each row that is better than the first one under other losses."""
    own, ahead = errors.errors(ordered[0].model), dict[Row, list[str]]()
    for name in choose_losses_to_show(loss):
        leader = min(ordered, key=lambda row: errors.errors(row.model)[name])
        if own[name] > EQUAL * errors.errors(leader.model)[name]:
            ahead.setdefault(leader, []).append(name)
    return [f"By {join_words(names)}, {_call(row)} is better." for row, names in ahead.items()]


def _compare_with_noise(errors: BlockErrors, error: float, loss: str) -> str:
    """Return a sentence on how far above the noise an error is, if that is known."""
    floor = errors.floor.get(loss, 0.0)
    if not floor > 0:
        return ""
    if error <= EQUAL * floor:
        return "No model can be better: the noise of the measurement is as large."
    if error > FAR * floor:
        return f"The error by {loss} is far above the noise of the measurement."
    return f"The error by {loss} is {error / floor:.2g} times that of a perfect model, the noise."


def _call(row: Row) -> str:
    """Return what a sentence calls a row."""
    return f"{row.name} ({row.pin.removeprefix(pins.PIN)})" if row.pin else row.name
