"""Reproduces Figure 9.2, balls of five materials of CUReT by nine models."""

import numpy as np
from brdfkit.theses.kurt2007.curet import load_sample
from brdfkit.theses.kurt2007.pictures import (
    MEANS,
    draw_picture_grid,
    render_pictures,
    show_differences,
    show_rendering,
)
from brdfkit.theses.kurt2007.printed import KOENDERINK, SEVEN, read_printed_table
from brdfkit.theses.kurt2007.table_9_2 import MODELS, POLYNOMIAL

from brdfkit.theses.claims import UNSTATED, Claim
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 60
SIZE, SPP = 72, 128
SHORT = {
    "Ashikhmin-Shirley": "Ashikhmin",
    KOENDERINK: "Koenderink",
    POLYNOMIAL: "polynomial",
}  # as it fits above a small picture
TEXT = """The fits of Table 9.2, with weights of any sign, on balls under the sky and softbox of
`render`; sums below 0 are black. *Measured* is the sample, interpolated between and beyond its 205
pairs of directions, so that all pictures depend as much on what was not measured. Each material has
its own exposure, since the unit of our data differs from sample to sample."""


def check_claims(sources, report):
    """Draw the balls, and return their section, with the PSNR of each picture."""
    materials = read_printed_table("table_9_2")["materials"]
    psnr = {name: [] for name in MODELS}
    errors = {name: [] for name in MODELS}
    rows = []
    for done, (material, number) in enumerate(materials.items(), 1):
        data = load_sample(sources, number)
        models = {
            name: data.fit(label, how, name in SEVEN).model for name, (label, how) in MODELS.items()
        }
        pictures = render_pictures({"measured": data.data, **models}, size=SIZE, spp=SPP)
        for name, (label, how) in MODELS.items():
            psnr[name].append(pictures.psnr()[name])
            errors[name].append(data.compute_error(label, how, name in SEVEN))
        rows += _draw_rows(material, pictures, titled=done == 1)
        report(done, len(materials))
    lines = [(name, *(f"{d:.1f}" for d in decibels)) for name, decibels in psnr.items()]
    table = Table(("PSNR [dB]", *materials), lines)
    claims = [_claim_pictures(psnr, errors, list(materials))]
    picture = Picture("figure_9_2", draw_picture_grid(rows, 0.9), MEANS)
    return Section("Figure 9.2: balls by nine models", TEXT, claims, [table], [picture])


def _draw_rows(label, pictures, titled):
    shown = show_rendering(pictures).items()
    cells = [(SHORT.get(name, name) if titled else "", picture) for name, picture in shown]
    apart = [("", picture) for picture in show_differences(pictures).values()]
    return [(label, cells), ("difference", [None, *apart])]


def _claim_pictures(psnr, errors, materials):
    from scipy.stats import spearmanr

    decibels, errors = (np.array(list(table.values())) for table in (psnr, errors))
    names = list(psnr)
    best = [names[row] for row in decibels.argmax(axis=0)]
    alike = [spearmanr(-e, d).statistic for e, d in zip(errors.T, decibels.T, strict=True)]
    return Claim(
        "The balls of nine models on five materials look as printed.",
        "Figure 9.2",
        "pictures, no figure",
        "nearest to the measured: "
        + ", ".join(f"{n} on {m}" for n, m in zip(best, materials, strict=True)),
        UNSTATED,
        "The thesis shows the balls, and gives no figure for them. A lower E is not a nearer "
        f"picture: their orders correlate by {min(alike):.2f} to {max(alike):.2f}, Spearman's.",
    )
