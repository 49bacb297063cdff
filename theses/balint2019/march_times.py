"""Measures the times of four marches by direction and ε, and reads those of Tables 6.1 to 6.3."""

import tomllib
from functools import partial
from pathlib import Path

import numpy as np
from brdfkit.theses.balint2019.dense import compute_dense_shadow
from brdfkit.theses.balint2019.measuring import compute_rms, measure_in_turns, read_shares
from brdfkit.theses.balint2019.scenes import MARCHES

from brdfkit.theses.page import Table

TIMES, RADIUS = 7, 0.5
INVERSES = 10, 20, 30, 256  # of ε
HEADS = {
    "table_6_1": "Table 6.1, a simple scene",
    "table_6_2": "Table 6.2, a complicated scene",
    "table_6_3": "Table 6.3, the Mandelbulb",
}
BASE, LINEAR, DISCRETE, CONVEX = range(4)  # columns of the tables, in the order of `MARCHES`


def list_settings():
    """Return pairs of 1 / ε, the inverse error bound, and direction, as in the printed rows."""
    return [(n, direction) for n in INVERSES for direction in "AB"]


def read_printed_times(name):
    """Return printed times (1, row, march) of the shadows alone, over the first one of `linear`."""
    text = Path(__file__).with_name("printed.toml").read_text(encoding="utf-8")
    table = tomllib.loads(text)[name]
    times = (
        np.array([table[f"1/{n} {direction}"] for n, direction in list_settings()]) - table["bare"]
    )
    return times[None] / times[0, LINEAR]


def measure_marches(view):
    """Return times (turn, row, march) of marches, mean evaluations and errors (row, march)."""
    field, cone = view.scene.field, view.make_cones(RADIUS)
    methods = {
        (row, march): partial(call, field, cone, 1 / n, direction)
        for row, (n, direction) in enumerate(list_settings())
        for march, call in enumerate(MARCHES.values())
    }
    seconds = measure_in_turns(methods, TIMES)
    model = read_shares(compute_dense_shadow(field, cone))
    times = np.zeros((TIMES, len(list_settings()), len(MARCHES)))
    found = np.zeros((2, *times.shape[1:]))
    for place, method in methods.items():
        shadow = method()
        error = compute_rms(read_shares(shadow) - model)
        times[:, *place] = seconds[place]
        found[:, *place] = np.mean(shadow.evaluations), error
    return times, *found


def make_times_table(name, ours, printed, evaluations):
    """Return a table of our times beside the printed ones."""
    rows = [
        (
            f"1/{n} {direction}",
            *(f"{a:.2f} / {b:.2f} ({e:.1f})" for a, b, e in zip(*columns, strict=True)),
        )
        for (n, direction), *columns in zip(
            list_settings(),
            *(np.exp(np.log(times).mean(axis=0)) for times in (ours, printed)),
            evaluations,
            strict=True,
        )
    ]
    caption = (
        f"{HEADS[name]}: times, ours / printed, and in brackets our mean number of evaluations."
    )
    return Table(("ε", *MARCHES), rows, caption)


def make_error_table(errors):
    """Return a table of errors by march, error bound ε and direction."""
    rows = [
        (
            name.replace("table_", "").replace("_", "."),
            f"1/{n} {direction}",
            *(f"{e:.5f}" for e in found[i]),
        )
        for name, found in errors.items()
        for i, (n, direction) in enumerate(list_settings())
    ]
    caption = "Errors against τ(r_min), root mean squares."
    return Table(("table", "ε", *MARCHES), rows, caption)
