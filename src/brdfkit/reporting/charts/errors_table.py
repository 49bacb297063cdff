"""The table of errors and albedos: a row for each fit, beside the measurement."""

from brdfkit.fitting.compare import format_error
from brdfkit.fitting.ranking.result import TAKE
from brdfkit.materials.measured.albedos import ANGLES
from brdfkit.regression.albedo_cells import format_albedo, is_wrong
from brdfkit.regression.light import WRONG
from brdfkit.reporting.verdict.verdict import in_words


def errors_table(standings, loss, measured):
    """A row for each `Standing`, under columns of losses, of which the one that ranks is first.

    The first `Standing` is that of the fit to take. Each cell of an error is its text and whether
    it is the best of its column; each of an albedo its text and whether it is wrong beside the
    `measured` one at the same angle.
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
                "albedos": [
                    (format_albedo(own), is_wrong(own, known))
                    for own, known in zip(one.albedos, measured, strict=True)
                ],
                "numbers": one.numbers,
                "typical": in_words(one.typical),
                "most": in_words(one.most),
                "verdict": TAKE if not number else "tied" if one.tied else "",
            }
        )
    return {
        "losses": by_loss,
        "angles": [f"{angle:g}°" for angle in ANGLES],
        "factor": WRONG,
        "measured": [(format_albedo(known), is_wrong(known)) for known in measured],
        "rows": rows,
    }
