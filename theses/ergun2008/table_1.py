"""Reproduces Table 1, the texture use and the aliasing of six projections of shadow maps."""

import numpy as np
from brdfkit.theses.ergun2008 import projection_claims, views
from brdfkit.theses.ergun2008.printed import average_cells
from brdfkit.theses.ergun2008.projection_claims import (
    average_lights,
    read_printed_rows,
    shorten_name,
)
from brdfkit.theses.ergun2008.simple_perspective import score_simple_perspective
from brdfkit.theses.ergun2008.views import PROJECTIONS, measure_all

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.shadows.comparison.scoring import score_texels
from brdfkit.shadows.maps.scenes import VIEWS
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 12
SCENES = ()  # names of the scenes to measure; by default all
COLUMNS = "unused, Q1", "relative", "aliasing, Q2 [dB]", "relative [dB]"
TEXT = """The thesis takes Q1 as the mean squared error of a histogram, of an untold unit; here it
is the share of the map that is *not* used, d / (1 + d), where d is that error over the square of
the histogram's mean: from 0 to 1, and small is good, as there. Q2 is the PSNR of the texels' areas
[pixels] as grey levels against black. Both depend on resolutions, which the thesis does not
tell."""


@in_turn
def check_claims(sources, report):
    """Check the claims on texture use and aliasing of six projections, and return their section."""
    use_variant()
    found = measure_all(score_projections, SCENES, report)
    names = list(PROJECTIONS)
    table = {
        scene: np.array(
            [[*compute_figures(q, i, 0), *compute_figures(q, i, 1)] for i in range(len(names))]
        )
        for scene, q in found.items()
    }
    claims = [
        projection_claims.claim_order("Texture use, best first.", "Table 1, 5", table, 0, -1),
        projection_claims.claim_best("POSM uses the map best.", table, 0, -1, "plane_optimal"),
        projection_claims.claim_worst("PSM uses it worst.", table, 0, -1, projection_claims.PSM),
        projection_claims.claim_focus(table),
        projection_claims.claim_order("Aliasing, least first.", "Table 1, 5", table, 2, 1),
        projection_claims.claim_best("POSM has the least aliasing.", table, 2, 1, "plane_optimal"),
        projection_claims.claim_worst("PSM has the most.", table, 2, 1, projection_claims.PSM),
        projection_claims.claim_simple(table, found),
        projection_claims.claim_even(table),
        projection_claims.claim_relative(table),
        projection_claims.claim_steadier(table),
        projection_claims.claim_lamp(found),
        projection_claims.claim_dueling(found),
    ]
    tables = [make_scene_table(table), make_view_table(found)]
    pictures = [Picture("table_1", draw_scores(table), "Table 1, printed and ours.")]
    return Section("Table 1: projections", TEXT, claims, tables, pictures)


def score_projections(view):
    """Return the unused share and the aliasing [dB] of each projection, and of simple PSM, in a
    view.
    """
    found = []
    for projection in PROJECTIONS:
        use, aliasing = score_texels(
            view.make_shadow(projection=projection), view.seen, view.placement
        )
        found.append((1 - use, aliasing))
    return [*found, score_simple_perspective(view, views.RESOLUTION)]


def compute_figures(cells, projection, score):
    """Return the mean and the relative score of a projection."""
    return average_cells(cells[..., projection, score])


def make_scene_table(table):
    """Return Table 1, printed and of each scene."""
    rows = [
        (
            PROJECTIONS[name],
            head,
            *(
                f"{values[i, column]:.{4 if column < 2 else 2}f}"
                for values in (read_printed_rows(), *table.values())
            ),
        )
        for column, head in enumerate(COLUMNS)
        for i, name in enumerate(PROJECTIONS)
    ]
    return Table(("projection", "score", "printed", *table), rows)


def make_view_table(found):
    """Return a table of texture use and aliasing by view, means of both lights."""
    rows = [
        (
            scene,
            PROJECTIONS[name],
            *(
                f"{average_lights(q, 0)[v, i]:.3f} / {average_lights(q, 1)[v, i]:.1f}"
                for v in range(4)
            ),
        )
        for scene, q in found.items()
        for i, name in enumerate(PROJECTIONS)
    ]
    caption = "Unused share / aliasing [dB] by view, means of both lights."
    return Table(("scene", "projection", *VIEWS), rows, caption)


def draw_scores(table):
    """Draw both scores as bars."""
    drawn = make_figure(9, 3.2)
    for axes, column in zip(drawn.subplots(1, 2), (0, 2), strict=True):
        sources = {"printed": read_printed_rows(), **table}
        wide = 0.8 / len(sources)
        for k, ((name, values), colour) in enumerate(zip(sources.items(), COLOURS, strict=False)):
            place = np.arange(len(PROJECTIONS)) + k * wide
            axes.bar(place, values[:, column], wide, color=colour, label=name)
        style_axes(axes, "", COLUMNS[column])
        axes.set_xticks(np.arange(len(PROJECTIONS)) + 0.3, [shorten_name(n) for n in PROJECTIONS])
        axes.tick_params(axis="x", labelrotation=30)
    drawn.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return drawn
