"""Reproduces Figure 9.3, a shape of green-latex by eight models, with differences."""

from brdfkit.theses.kurt2007.neural import load_neural_material
from brdfkit.theses.kurt2007.pictures import (
    MEANS,
    draw_picture_grid,
    render_without_noise,
    show_differences,
    show_rendering,
    unpack_mesh,
)
from brdfkit.theses.kurt2007.table_9_3 import POLYNOMIAL, fit_models

from brdfkit.theses.claims import Claim
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 60
MATERIAL, MEASURED = "green-latex", "neural"
MESHES = "stanford-bunny", "alligator", "cow"
MAPS = "studio", "sky", "room"  # environment maps that come with brdfkit
COLUMNS = 5
TEXT = f"""The thesis renders a dragon; the Stanford dragon is not at hand, so the figure shows the
Stanford bunny. The models are those of Table 9.3, fitted to the neural reconstruction of
{MATERIAL}. Its light is not told: the claim is judged over {len(MESHES)} shapes under
{len(MAPS)} maps; the figure is under the first of them. The pictures are previews, which have no
noise and no light from surface to surface."""


def check_claims(sources, report):
    """Check the claim on the pictures of green-latex; return its section with the figure."""
    data = load_neural_material(sources, MATERIAL)
    models = {MEASURED: data, **fit_models(sources, MATERIAL)}
    psnr, rows = {}, []
    for name in MESHES:
        with unpack_mesh(sources, name) as mesh:
            if name == MESHES[0]:
                rows = _draw_rows(render_without_noise(models, mesh, shadows=True))
            for light in MAPS:
                psnr[name, light] = render_without_noise(models, mesh, light).psnr()
                report(len(psnr), len(MESHES) * len(MAPS))
    picture = Picture("figure_9_3", draw_picture_grid(rows, 1.5), MEANS)
    title = "Figure 9.3: eight models on a shape"
    return Section(title, TEXT, [_claim_best(psnr)], [_make_table(psnr)], [picture])


def _draw_rows(pictures):
    """Return the rows of the figure: pictures, and their differences below them."""
    shown = [*show_rendering(pictures).items()]
    apart = [None, *(("", picture) for picture in show_differences(pictures).values())]
    rows = []
    for start in range(0, len(shown), COLUMNS):
        rows += [
            ("picture", shown[start : start + COLUMNS]),
            ("difference", apart[start : start + COLUMNS]),
        ]
    return rows


def _make_table(psnr):
    names = list(next(iter(psnr.values())))
    lines = [(name, *(f"{cell[name]:.1f}" for cell in psnr.values())) for name in names]
    return Table(("PSNR [dB]", *(f"{mesh}, {light}" for mesh, light in psnr)), lines)


def _claim_best(psnr):
    holds = {cell: max(found, key=found.get) == POLYNOMIAL for cell, found in psnr.items()}
    ours, verdict = judge_over_grid(["shape", "light"], holds)
    leads = [
        found[POLYNOMIAL] - max(d for name, d in found.items() if name != POLYNOMIAL)
        for found in psnr.values()
    ]
    return Claim(
        f"On {MATERIAL} the polynomial of degree 5 has the best picture of eight models.",
        "Figure 9.3",
        "46.5 dB, the next 44.4 dB",
        f"{ours}; {min(leads):+.1f} to {max(leads):+.1f} dB to the best other model",
        verdict,
        "In linear values, over the pixels of the shape. Under a single light it may hold "
        "on another shape as well: see the table.",
    )
