"""The table of errors: a row for each fit."""

from brdfkit.ranking.result import TAKE
from brdfkit.reporting.verdict import in_words
from brdfkit.verbs.compare import format_error


def errors_table(standings, loss):
    """A row for each `Standing`, under columns of losses, of which the one that ranks is first.

    The first `Standing` is that of the fit to take. Each cell is its text and whether it is the
    best of its column.
    """
    by_loss = sorted(standings[0].errors, key=lambda name: name != loss)
    rows = []
    for number, one in enumerate(standings):
        cells = [
            (format_error(one.errors[n]), one.errors[n] == min(s.errors[n] for s in standings))
            for n in by_loss
        ]
        rows.append(
            {
                "cells": cells,
                "numbers": one.numbers,
                "typical": in_words(one.typical),
                "most": in_words(one.most),
                "verdict": TAKE if not number else "tied" if one.tied else "",
            }
        )
    return {"losses": by_loss, "rows": rows}
