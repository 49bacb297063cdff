"""Reproduces Table 9.4, the times of fits, compared by their ratios because machines differ."""

import numpy as np
from brdfkit.theses.kurt2007.curet import BISQUARE, OLS, WLS, load_samples
from brdfkit.theses.kurt2007.printed import SEVEN, read_printed_table

from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 2
POLYNOMIAL = "Polynomial (p = 7)"
LABEL = "pca_polynomial:degree=7"
TEXT = """The median over the 52 samples of the time of a fit, divided by that of the polynomial
(the first fit of a model compiles its kernels, so the mean would be of that). The machines are 19
years apart, so only ratios are compared; and brdfkit searches all starts at once by
Levenberg-Marquardt in compiled code, where the thesis ran SQP in MATLAB from a start or a few."""


def check_claims(sources, report):
    """Check the claims on the times of fits; return their section of the page."""
    found = load_samples(sources).values()

    def measure_median_seconds(label, how):
        times = [data.fit(label, how).seconds for data in found]
        report(1, 1)
        return float(np.median(times))

    ours = {name: measure_median_seconds(label, WLS) for name, label in SEVEN.items()}
    polynomial = {how: measure_median_seconds(LABEL, how) for how in (BISQUARE, OLS)}
    theirs = read_printed_table("table_9_4")
    least = theirs[POLYNOMIAL]
    lines = [
        (
            name,
            f"{theirs[name]:.4f}",
            f"{theirs[name] / least:.1f}",
            f"{ours[name]:.4f}",
            f"{ours[name] / polynomial[BISQUARE]:.2f}",
            f"{ours[name] / polynomial[OLS]:.1f}",
        )
        for name in SEVEN
    ]
    heads = "model", "printed [s]", "ratio", "ours [s]", "to bisquare", "to least squares"
    times = [polynomial[BISQUARE], polynomial[OLS]]
    caption = (
        f"Ratios to the polynomial: printed {least:.4f} s; ours {times[0]:.4f} s by bisquare, "
        f"{times[1]:.4f} s by least squares. Ours differ from run to run."
    )
    ratios = [min(ours.values()) / t for t in times]
    claim = Claim(
        "The polynomial takes about half the time of the other fits.",
        "Table 9.4",
        f"fastest rival {min(theirs[n] for n in SEVEN) / least:.1f} times, slowest "
        f"{max(theirs[n] for n in SEVEN) / least:.1f} times as long",
        f"fastest rival {ratios[0]:.2f} times as long as bisquare, {ratios[1]:.1f} times as least "
        "squares",
        to_verdict(ratios[0] >= 2),
        "About the programs, not the models. A pass of bisquare is a linear solution of 15 "
        "weights, so that all passes take less than what else a fit does: starting, albedos, "
        "notes. Our nonlinear searches run all their starts in one kernel.",
    )
    return Section("Table 9.4: time", TEXT, [claim], [Table(heads, lines, caption)])
