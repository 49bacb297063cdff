"""Reproduces Table 9.1, the error of the polynomial by its degree on Cayman lacquer and a tile."""

import numpy as np
from brdfkit.theses.kurt2007.curet import (
    BISQUARE,
    OLS,
    PLAIN,
    WLS,
    compute_error,
    find_scale,
    load_sample,
)
from brdfkit.theses.kurt2007.printed import read_printed_table

from brdfkit.fitting.fit import fit
from brdfkit.materials.loading import load
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.selection import select_samples
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 20
DEGREES = range(1, 7)
QUARRY = "Quarry tile"
WIDEST = 80.5  # degrees: the thesis leaves out angles beyond 80°, at which Cornell also measured
TEXT = """By bisquare without a cosine, as the thesis fits; E by eq. 5.13. Quarry tile is
multiplied by the factor of its sample, which the seven nonlinear models of Table 9.2 have. Cayman
is read as linear sRGB, so that its unit is not the thesis's; *without the peak* leaves out the
one pair at θ_i 80°, θ_r 79°, φ 180°, which is 34 times the next largest value."""


def check_claims(sources, report):
    """Check the claims on the error of the polynomial by its degree, and return their section."""
    cayman = load(sources.find_file("cornell/cayman.brdf")).rgb
    calm = _remove_peak(cayman)
    quarry = load_sample(sources, read_printed_table("table_9_2")["materials"][QUARRY])
    factor = find_scale(quarry, _read_printed_errors(QUARRY))
    rows = {"all": [], "calm": [], "bisquare": [], "OLS": [], "WLS": []}
    for p in DEGREES:
        label = f"pca_polynomial:degree={p}"
        found = fit_polynomial(label, cayman)
        rows["all"].append(compute_error(found.model, select_samples(cayman, WIDEST)))
        smooth = fit_polynomial(label, calm)
        rows["calm"].append(compute_error(smooth.model, select_samples(calm, WIDEST)))
        for name, how in (("bisquare", BISQUARE), ("OLS", OLS), ("WLS", WLS)):
            rows[name].append(factor * quarry.compute_error(label, how))
        report(p, len(DEGREES))
    rows = {name: np.array(errors) for name, errors in rows.items()}
    return Section(
        "Table 9.1: degree of the polynomial",
        TEXT,
        _make_claims(rows),
        [_make_table(rows)],
    )


def fit_polynomial(label, data):
    """Return a model's fit to measured data with bisquare weights, and without cosines."""
    return fit(data, label, loss=PLAIN, robust="bisquare", max_angle=WIDEST, extrapolate="free")


def _remove_peak(data):
    """Return a measured material without its largest value."""
    kept = np.arange(len(data.values)) != data.values.sum(axis=1).argmax()
    wi, wo, values = (a[kept] for a in (data.samples.wi, data.samples.wo, data.values))
    return Measured.from_samples(wi, wo, values, name=data.name)


def _read_printed_errors(material):
    table = read_printed_table("table_9_2")
    column = list(table["materials"]).index(material)
    return {name: errors[column] for name, errors in table["errors"].items()}


def _make_table(rows):
    table = read_printed_table("table_9_1")
    lines = [
        ("parameters 2p + 5", *map(str, table["parameters"])),
        ("Cayman, printed", *(f"{e:.3f}" for e in table["cayman"])),
        ("Cayman, ours", *(f"{e:.3f}" for e in rows["all"])),
        ("Cayman without the peak, ours", *(f"{e:.3f}" for e in rows["calm"])),
        ("quarry tile, printed", *(f"{e:.3f}" for e in table["quarry_tile"])),
        ("quarry tile, ours, bisquare", *(f"{e:.3f}" for e in rows["bisquare"])),
        ("quarry tile, ours, least squares", *(f"{e:.3f}" for e in rows["OLS"])),
        ("quarry tile, ours, least E", *(f"{e:.3f}" for e in rows["WLS"])),
    ]
    return Table(("L2 error", *(f"p = {p}" for p in DEGREES)), lines)


def _make_claims(rows):
    table, where = read_printed_table("table_9_1"), "Table 9.1"
    tile = np.array(table["quarry_tile"])
    near = [np.abs(rows[n] / tile - 1) <= 0.2 for n in ("bisquare", "OLS", "WLS")]
    below = [p for p, e, least in zip(DEGREES, tile, rows["WLS"], strict=True) if e < 0.95 * least]
    moved = np.ptp(rows["all"]) / rows["all"][0]
    falls = bool((np.diff(rows["bisquare"]) < 0).all())
    without = rows["all"][-1] / rows["calm"][-1]
    return [
        Claim(
            "On quarry tile a higher degree has a smaller error.",
            where,
            f"{tile[0]:.3f} to {tile[-1]:.3f}",
            f"{rows['bisquare'][0]:.3f} to {rows['bisquare'][-1]:.3f} (bisquare), "
            f"{rows['WLS'][0]:.3f} to {rows['WLS'][-1]:.3f} (least E)",
            to_verdict(falls),
            "It falls with every degree, by bisquare as by least E.",
        ),
        Claim(
            "The errors on quarry tile themselves.",
            where,
            " ".join(f"{e:.3f}" for e in tile),
            " ".join(f"{e:.3f}" for e in rows["bisquare"]),
            to_verdict(near[0].all()),
            f"Within 20 %: {near[0].sum()} of 6 by bisquare, {near[1].sum()} by least squares, "
            f"{near[2].sum()} by least E. At p = {', '.join(map(str, below))} the thesis prints "
            "less than the least E that a sum without interactions has on these averaged data; a "
            "full polynomial with interactions comes near. Unexplained.",
        ),
        Claim(
            "On Cayman lacquer the error does not move with the degree.",
            where,
            "2.199 to 2.198",
            f"{rows['all'][0]:.3f} to {rows['all'][-1]:.3f}",
            to_verdict(moved < 0.005),
            f"Because of one sample: bisquare gives it no weight, and its residual alone makes E. "
            f"Without it E is {without:.0f} times smaller ({rows['calm'][0]:.3f} to "
            f"{rows['calm'][-1]:.3f}). The unit differs with the conversion of the spectra.",
        ),
    ]  # fmt: skip
