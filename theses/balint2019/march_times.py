"""Times of the four marches by direction and ε: ours, and those printed in tables 6.1 to 6.3."""

import tomllib
from functools import partial
from pathlib import Path

import numpy as np
from brdfkit.theses.balint2019.dense import dense
from brdfkit.theses.balint2019.measuring import rms, seconds_in_turns, shares
from brdfkit.theses.balint2019.scenes import MARCHES

from brdfkit.theses.page import Table

TIMES, RADIUS = 3, 0.5
INVERSES = 10, 20, 30, 256  # of ε
HEADS = {
    "table_6_1": "Table 6.1, a simple scene",
    "table_6_2": "Table 6.2, a complicated scene",
    "table_6_3": "Table 6.3, the Mandelbulb",
}
BASE, LINEAR, DISCRETE, CONVEX = range(4)  # the columns, as `MARCHES`


def settings():
    """(1 / ε, direction) in the order of the printed rows."""
    return [(n, direction) for n in INVERSES for direction in "AB"]


def printed_times(name):
    """Times (row, march) of the shadows alone, over that of `linear` in the first row."""
    text = Path(__file__).with_name("printed.toml").read_text(encoding="utf-8")
    table = tomllib.loads(text)[name]
    times = np.array([table[f"1/{n} {direction}"] for n, direction in settings()]) - table["bare"]
    return times / times[0, LINEAR]


def measure(view):
    """Times and mean evaluations (row, march), and errors (row, march) against τ(r_min)."""
    field, cone = view.scene.field, view.cones(RADIUS)
    methods = {
        (row, march): partial(call, field, cone, 1 / n, direction)
        for row, (n, direction) in enumerate(settings())
        for march, call in enumerate(MARCHES.values())
    }
    seconds = seconds_in_turns(methods, TIMES)
    model = shares(dense(field, cone))
    found = np.zeros((3, len(settings()), len(MARCHES)))
    for place, method in methods.items():
        shadow = method()
        error = rms(shares(shadow) - model)
        found[:, *place] = seconds[place], np.mean(shadow.evaluations), error
    return found


def times_table(name, ours, printed, evaluations):
    """Ours beside the printed."""
    rows = [
        (
            f"1/{n} {direction}",
            *(f"{a:.2f} / {b:.2f} ({e:.0f})" for a, b, e in zip(*columns, strict=True)),
        )
        for (n, direction), *columns in zip(settings(), ours, printed, evaluations, strict=True)
    ]
    caption = (
        f"{HEADS[name]}: times, ours / printed, and in brackets our mean number of evaluations."
    )
    return Table(("ε", *MARCHES), rows, caption)


def error_table(errors):
    """Errors by march and ε, in direction A."""
    rows = [
        (
            name.replace("table_", "").replace("_", "."),
            f"1/{n}",
            *(f"{e:.5f}" for e in found[2 * i]),
        )
        for name, found in errors.items()
        for i, n in enumerate(INVERSES)
    ]
    caption = "Errors against τ(r_min), root mean squares, in direction A."
    return Table(("table", "ε", *MARCHES), rows, caption)
