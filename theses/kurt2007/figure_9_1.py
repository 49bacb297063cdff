"""Reproduces Figure 9.1, vases of Cayman lacquer and quarry tile by the polynomial's degree."""

import numpy as np
from brdfkit.theses.kurt2007.curet import BISQUARE, load_sample
from brdfkit.theses.kurt2007.pictures import (
    MEANS,
    draw_picture_grid,
    render_pictures,
    show_differences,
    show_rendering,
)
from brdfkit.theses.kurt2007.printed import read_printed_table
from brdfkit.theses.kurt2007.table_9_1 import DEGREES, QUARRY, fit_polynomial

from brdfkit.core.colours import luminance
from brdfkit.materials.loading import load
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 40
CAYMAN = "Cayman"
SIZE, SPP = 96, 256
RISE = 1.0  # dB: a smaller rise of the PSNR can hardly be seen
PEAK = 99.5  # percentile of the luminance that is the highlight
TEXT = f"""Vases of the scene of that name, and balls, under the sky and softbox of `render`,
because the thesis tells neither its vase nor its light: the measured material, interpolated, and
the polynomials by bisquare, as in Table 9.1. *Highlight*: the {PEAK}th percentile of the luminance
in the pixels of the vase, over that of the measured one."""


def check_claims(sources, report):
    """Check what the pictures show by the degree of the polynomial; return the section."""
    tile = load_sample(sources, read_printed_table("table_9_2")["materials"][QUARRY])
    cayman = load(sources.find_file("cornell/cayman.brdf")).rgb
    materials = {
        CAYMAN: (cayman, lambda label: fit_polynomial(label, cayman).model),
        QUARRY: (tile.data, lambda label: tile.fit(label, BISQUARE).model),
    }
    psnr, peaks, rows = {}, {}, []
    for name, (data, fit_model) in materials.items():
        shown = {"measured": data}
        shown |= {f"p = {p}": fit_model(f"pca_polynomial:degree={p}") for p in DEGREES}
        for shape in ("vase", "ball"):
            pictures = render_pictures(shown, shape, size=SIZE, spp=SPP)
            psnr[name, shape] = list(pictures.psnr().values())
            if shape == "vase":
                peaks[name] = _measure_highlights(pictures)
                rows += _draw_rows(name, pictures)
            report(len(psnr), 4)
    claims = [_claim_degrees(psnr), _claim_highlights(peaks)]
    picture = Picture("figure_9_1", draw_picture_grid(rows), MEANS)
    table = _make_table(psnr, peaks)
    return Section("Figure 9.1: vases by the degree", TEXT, claims, [table], [picture])


def _measure_highlights(pictures):
    """Return the brightness of the highlight in each other picture, over that in the first."""
    values = [np.percentile(luminance(p)[pictures.mask], PEAK) for p in pictures.pictures.values()]
    return np.array(values[1:]) / values[0]


def _draw_rows(name, pictures):
    apart = show_differences(pictures).values()
    return [
        (name, list(show_rendering(pictures).items())),
        ("difference", [None, *(("", picture) for picture in apart)]),
    ]


def _make_table(psnr, peaks):
    lines = [
        (f"{name}, {shape}, PSNR [dB]", *(f"{d:.1f}" for d in decibels))
        for (name, shape), decibels in psnr.items()
    ]
    lines += [(f"{name}, highlight", *(f"{v:.2f}" for v in found)) for name, found in peaks.items()]
    return Table(("pictures", *(f"p = {p}" for p in DEGREES)), lines)


def _claim_degrees(psnr):
    ours, verdict = judge_over_grid(
        ["material", "shape"],
        {cell: d[-1] - d[0] > RISE and max(d) - d[-1] <= RISE for cell, d in psnr.items()},
    )
    rises = ", ".join(
        f"{name} {d[0]:.1f} to {d[-1]:.1f} dB, best {max(d):.1f} dB at p = {DEGREES[np.argmax(d)]}"
        for (name, shape), d in psnr.items()
        if shape == "vase"
    )
    falls = [max(0.0, -np.diff(d).min()) for d in psnr.values()]
    return Claim(
        "The picture improves with the degree, from p = 1 to 6.",
        "Figure 9.1",
        "pictures, no figure",
        f"{ours}: {rises}, on the vase",
        verdict,
        f"It holds where p = 6 is better than p = 1 by more than {RISE:g} dB, and no degree "
        "between is better than p = 6 by more. The largest fall from one degree to the next is "
        f"{max(falls):.1f} dB.",
    )


def _claim_highlights(peaks):
    reach = {name: found[-1] for name, found in peaks.items()}
    return Claim(
        "Specularity appears as the degree grows.",
        "Figure 9.1",
        "pictures of Cayman and quarry tile",
        ", ".join(f"{name} {f[0]:.2f} to {f[-1]:.2f}" for name, f in peaks.items())
        + " of the measured highlight",
        to_verdict(all(f[-1] > f[0] for f in peaks.values()) and min(reach.values()) >= 0.5),
        "Confirmed if it grows on both, to at least half of the measured one. To bisquare the "
        "highlight of Cayman as a whole is outliers, whatever the degree; that of quarry tile is "
        f"nearly whole at p = 1, and has no room to grow: it is {peaks[QUARRY].max():.2f} at most.",
    )
