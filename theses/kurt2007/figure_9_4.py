"""Reproduces Figure 9.4, errors of eight models on 52 samples of CUReT.

The thesis says that its polynomial of degree 7 has the lowest error on most of them.
"""

import numpy as np
from brdfkit.theses.kurt2007.appendix_3 import read_rows
from brdfkit.theses.kurt2007.curet import METHODS, NUMBERS, compute_errors, find_scale, load_samples
from brdfkit.theses.kurt2007.printed import SEVEN

from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import draw_curves, make_figure
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section

SECONDS = 12
POLYNOMIAL = "pca_polynomial:degree=7"
WON = 35  # printed number of samples, of 52, on which the polynomial has the lowest error
TOLERANCE = 2  # samples by which the number may differ
TEXT = """The samples are sorted by the error of Cook-Torrance, as in the thesis. *Ours*: every
model fitted here on the same averaged data, so that no scale is needed. *Printed*: the errors of
the seven from Appendix 3, with our polynomial multiplied by one factor per sample, the median of
printed / ours over the seven. All with weights of any sign, as in the thesis."""


def check_claims(sources, report):
    """Check the claims on the errors of eight models; return their section of the page."""
    ours = {name: compute_errors(sources, label, signed=True) for name, label in SEVEN.items()}
    report(1, 5)
    found = {}
    for done, (method, how) in enumerate(METHODS.items()):
        found[method] = compute_errors(sources, POLYNOMIAL, how)
        report(2 + done, 5)
    theirs = _read_printed_errors(sources)
    factor = None
    if theirs is not None:
        factor = [
            find_scale(data, {n: e[k] for n, e in theirs.items()})
            for k, data in enumerate(load_samples(sources).values())
        ]
    against_ours = {m: _count_wins(e, ours) for m, e in found.items()}
    against_printed = (
        {} if factor is None else {m: _count_wins(e * factor, theirs) for m, e in found.items()}
    )
    claims = [
        *_make_claims_of_wins(against_ours, against_printed),
        _claim_ward_order(ours, theirs),
    ]
    picture = _draw_figure(ours, theirs, found["bisquare"], factor)
    return Section("Figure 9.4: eight models on 52 materials", TEXT, claims, (), [picture])


def _read_printed_errors(sources):
    """Return the errors (52,) of Appendix 3 by model, NaN where illegible; None if missing."""
    rows = read_rows(sources)
    if rows is None:
        return None
    names = {label: name for name, label in SEVEN.items()}
    found = {name: np.full(len(NUMBERS), np.nan) for name in SEVEN}
    for row in rows:
        found[names[row.model]][NUMBERS.index(row.number)] = row.error
    return found


def _count_wins(polynomial, others):
    """Return on how many samples the polynomial has the lowest error."""
    return int((polynomial < np.nanmin(list(others.values()), axis=0)).sum())


def _make_claims_of_wins(against_ours, against_printed):
    """Return the claims on the samples that the polynomial wins, over its fits and the errors."""
    counts = {(method, "ours"): n for method, n in against_ours.items()}
    counts |= {(method, "printed"): n for method, n in against_printed.items()}
    names = ["polynomial's fit", "others' errors"]
    most, of_most = judge_over_grid(names, {c: n > len(NUMBERS) / 2 for c, n in counts.items()})
    near, of_near = judge_over_grid(
        names, {c: abs(n - WON) <= TOLERANCE for c, n in counts.items()}
    )
    words = "; ".join(
        f"against {'ours' if of is against_ours else 'the printed errors'} "
        + ", ".join(f"{n} ({method})" for method, n in of.items())
        for of in (against_printed, against_ours)
        if of
    )
    return (
        Claim(
            "The polynomial of degree 7 has the lowest of eight errors on most samples.",
            "Figure 9.4",
            f"{WON} of 52",
            f"{most}: {min(counts.values())} to {max(counts.values())} of 52",
            of_most,
            "With more weights than the seven: 15 a channel, where they have 2 to 5.",
        ),
        Claim(
            f"The polynomial of degree 7 has the lowest of eight errors on {WON} of 52 samples.",
            "Figure 9.4",
            f"{WON} of 52",
            f"{near}: {words}",
            of_near,
            f"Tolerance ±{TOLERANCE}. The count depends on how the polynomial is fitted: by "
            "bisquare, which the thesis names, it is "
            f"{(against_printed or against_ours)['bisquare']}; plain least squares comes nearest.",
        ),
    )


def _claim_ward_order(ours, theirs):
    counts = [np.sum(e["Ward-Dür"] < e["Ward"]) for e in (theirs or {}, ours) if e]
    return Claim(
        "Ward-Dür fits better than Ward.",
        "3.1",
        f"{counts[0]} of 52 in Appendix 3" if theirs else "no figure",
        f"{counts[-1]} of 52",
        to_verdict(counts[-1] > len(NUMBERS) / 2),
    )  # fmt: skip


def _draw_figure(ours, theirs, polynomial, factor):
    """Draw the models' errors as curves: ours and, unless the table is missing, printed ones."""
    panels = {"ours": ({**ours, "polynomial, p = 7": polynomial}, "E, one channel [sr⁻¹]")}
    if theirs is not None:
        scaled = {**theirs, "polynomial, p = 7": polynomial * factor}
        panels["printed; the polynomial is ours"] = scaled, "E, three channels [sr⁻¹]"
    drawn = make_figure(7.6, 3.1 * len(panels))
    for number, (title, (curves, unit)) in enumerate(panels.items(), 1):
        axes = drawn.add_subplot(len(panels), 1, number)
        order = np.argsort(np.nan_to_num(curves["Cook-Torrance"]))
        draw_curves(axes, {name: e[order] for name, e in curves.items()}, title, unit)
    drawn.axes[-1].set_xlabel("samples of CUReT, by the error of Cook-Torrance")
    drawn.legend(*drawn.axes[0].get_legend_handles_labels(), loc="outside right", frameon=False)
    return Picture("figure_9_4", drawn, "The polynomial by bisquare, thick.")
