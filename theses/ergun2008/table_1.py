"""Table 1: how much of a map six projections use, and how finely they sample what is seen."""

import numpy as np
from brdfkit.theses.ergun2008 import projection_claims as claim
from brdfkit.theses.ergun2008 import views
from brdfkit.theses.ergun2008.printed import mean_and_relative
from brdfkit.theses.ergun2008.projection_claims import printed_table, short, view_means
from brdfkit.theses.ergun2008.simple_perspective import simple_scores
from brdfkit.theses.ergun2008.views import PROJECTIONS, measured

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.shadows.comparison.scoring import score_texels
from brdfkit.shadows.maps.scenes import VIEWS
from brdfkit.theses.drawing import COLOURS, figure, tidy
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 12
SCENES = ()  # by default all
COLUMNS = "unused, Q1", "relative", "aliasing, Q2 [dB]", "relative [dB]"
TEXT = """The thesis takes Q1 as the mean squared error of a histogram, of an untold unit; here it
is the share of the map that is *not* used, d / (1 + d), where d is that error over the square of
the histogram's mean: from 0 to 1, and small is good, as there. Q2 is the PSNR of the texels' areas
[pixels] as grey levels against black. Both depend on resolutions, which the thesis does not
tell."""


@in_turn
def run(sources, report):
    """The scores, and the claims on them."""
    use_variant()
    found = measured(scores, SCENES, report)
    names = list(PROJECTIONS)
    table = {
        scene: np.array([[*figures(q, i, 0), *figures(q, i, 1)] for i in range(len(names))])
        for scene, q in found.items()
    }
    claims = [
        claim.order_claim("Texture use, best first.", "Table 1, 5", table, 0, -1),
        claim.best_claim("POSM uses the map best.", table, 0, -1, "plane_optimal"),
        claim.worst_claim("PSM uses it worst.", table, 0, -1, claim.PSM),
        claim.focus_claim(table),
        claim.order_claim("Aliasing, least first.", "Table 1, 5", table, 2, 1),
        claim.best_claim("POSM has the least aliasing.", table, 2, 1, "plane_optimal"),
        claim.worst_claim("PSM has the most.", table, 2, 1, claim.PSM),
        claim.simple_claim(table, found),
        claim.even_claim(table),
        claim.relative_claim(table),
        claim.steadier_claim(table),
        claim.lamp_claim(found),
        claim.dueling_claim(found),
    ]
    tables = [scene_table(table), view_table(found)]
    pictures = [Picture("table_1", draw(table), "Table 1, printed and ours.")]
    return Section("Table 1: projections", TEXT, claims, tables, pictures)


def scores(view):
    """(unused share, aliasing [dB]) of each projection, and of PSM in the simple way."""
    found = []
    for projection in PROJECTIONS:
        use, aliasing = score_texels(view.shadow(projection=projection), view.seen, view.placement)
        found.append((1 - use, aliasing))
    return [*found, simple_scores(view, views.RESOLUTION)]


def figures(cells, projection, score):
    """Mean and relative score of a projection."""
    return mean_and_relative(cells[..., projection, score])


def scene_table(table):
    """Table 1, printed and of each scene."""
    rows = [
        (
            PROJECTIONS[name],
            head,
            *(
                f"{values[i, column]:.{4 if column < 2 else 2}f}"
                for values in (printed_table(), *table.values())
            ),
        )
        for column, head in enumerate(COLUMNS)
        for i, name in enumerate(PROJECTIONS)
    ]
    return Table(("projection", "score", "printed", *table), rows)


def view_table(found):
    """Q1 and Q2 by view: the means of both lights."""
    rows = [
        (
            scene,
            PROJECTIONS[name],
            *(f"{view_means(q, 0)[v, i]:.3f} / {view_means(q, 1)[v, i]:.1f}" for v in range(4)),
        )
        for scene, q in found.items()
        for i, name in enumerate(PROJECTIONS)
    ]
    caption = "Unused share / aliasing [dB] by view, means of both lights."
    return Table(("scene", "projection", *VIEWS), rows, caption)


def draw(table):
    """Both scores as bars."""
    drawn = figure(9, 3.2)
    for axes, column in zip(drawn.subplots(1, 2), (0, 2), strict=True):
        sources = {"printed": printed_table(), **table}
        wide = 0.8 / len(sources)
        for k, ((name, values), colour) in enumerate(zip(sources.items(), COLOURS, strict=False)):
            place = np.arange(len(PROJECTIONS)) + k * wide
            axes.bar(place, values[:, column], wide, color=colour, label=name)
        tidy(axes, "", COLUMNS[column])
        axes.set_xticks(np.arange(len(PROJECTIONS)) + 0.3, [short(n) for n in PROJECTIONS])
        axes.tick_params(axis="x", labelrotation=30)
    drawn.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return drawn
