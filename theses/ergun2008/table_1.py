"""Reproduces Table 1, the texture use and the aliasing of six projections of shadow maps."""

from itertools import product

import numpy as np
from brdfkit.theses.ergun2008 import projection_claims as claims
from brdfkit.theses.ergun2008.projection_claims import (
    FITTED,
    PSM,
    SIMPLE,
    compute_figures,
    read_printed_rows,
    shorten_name,
)
from brdfkit.theses.ergun2008.simple_perspective import NEAR, score_simple_perspective
from brdfkit.theses.ergun2008.views import PROJECTIONS, measure_all

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.shadows.comparison.scoring import score_texels
from brdfkit.shadows.maps.scenes import VIEWS
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 60
SCENES = ()  # names of the scenes to measure; by default all
RESOLUTIONS = 512, 1024
COLUMNS = "unused, Q1", "relative", "aliasing, Q2 [dB]", "relative [dB]"
SIMPLE_PSM = "perspective (PSM), simple"
TEXT = f"""The thesis takes Q1 as the mean squared error of a histogram, of an untold unit; here it
is the share of the map that is *not* used, d / (1 + d), where d is that error over the square of
the histogram's mean: from 0 to 1, and small is good, as there. Q2 is the PSNR of the texels' areas
[pixels] as grey levels against black. Both depend on resolutions, which the thesis does not
tell, nor which form its PSM has. So each claim is tried for all scenes × maps of
{" and ".join(f"{n}²" for n in RESOLUTIONS)} texels, and with both forms of PSM where it is about
PSM: *fitted*, as in brdfkit, and *simple*, with the light's view opened to the whole cube, evenly
about its axis, and the camera's near plane at {NEAR:g} of the nearest distance."""


@in_turn
def check_claims(sources, report):
    """Check the claims on texture use and aliasing of six projections, and return their section."""
    use_variant()
    found = measure_all(score_projections, SCENES, report)
    grid = make_grid(found)
    one_scene = "The printed order is that of one scene, which is not described."
    plane = (
        "The scenes differ by how much of the picture is the plane: by design the best map is of "
        "that alone."
    )
    order = f"{one_scene} Projections within {claims.PARTED:g} dB there are not ordered."
    posm, forms = claims.POSM, claims.FORMS
    made = [
        claims.claim_order("Texture use, best first.", grid, 0, -1, 0.0, one_scene),
        claims.claim_extreme("POSM uses the map best.", grid, 0, -1, posm, plane),
        claims.claim_extreme("PSM uses it worst.", grid, 0, 1, PSM, forms),
        claims.claim_focus(grid),
        claims.claim_order("Aliasing, least first.", grid, 2, 1, claims.PARTED, order),
        claims.claim_extreme("POSM has the least aliasing.", grid, 2, 1, posm, plane),
        claims.claim_extreme("PSM has the most.", grid, 2, -1, PSM, forms),
        claims.claim_even(grid),
        claims.claim_steadiest(grid),
        claims.claim_steadier(grid),
        claims.claim_lamp(grid),
        claims.claim_dueling(grid),
    ]
    tables = [make_scene_table(found), make_view_table(found)]
    caption = f"Table 1, printed, and ours with maps of {RESOLUTIONS[0]}² texels."
    pictures = [Picture("table_1", draw_scores(found), caption)]
    return Section("Table 1: projections", TEXT, made, tables, pictures)


def score_projections(view):
    """Return scores (maps, 7, 2) in a view: the unused share and the aliasing [dB].

    Of the projections, and last of simple PSM.
    """
    found = []
    for resolution in RESOLUTIONS:
        shadows = [view.make_shadow(projection=p, resolution=resolution) for p in PROJECTIONS]
        scores = [score_texels(shadow, view.seen, view.placement) for shadow in shadows]
        rows = [(1 - use, aliasing) for use, aliasing in scores]
        found.append([*rows, score_simple_perspective(view, resolution)])
    return found


def make_grid(found):
    """Return the scores (view, light, 6, 2) in each cell: a scene, a map and a form of PSM."""
    grid = {}
    for (scene, scores), (k, resolution) in product(found.items(), enumerate(RESOLUTIONS)):
        for form in (FITTED, SIMPLE):
            own = scores[:, :, k, : len(PROJECTIONS)].copy()
            if form == SIMPLE:
                own[:, :, PSM] = scores[:, :, k, -1]
            grid[scene, f"{resolution}²", form] = own
    return grid


def compute_first_figures(found):
    """Return the rows of Table 1 (7, 4) by scene, with the first size of maps."""
    return {scene: compute_figures(scores[:, :, 0]) for scene, scores in found.items()}


def make_scene_table(found):
    """Return Table 1, printed and of each scene."""
    names = [*PROJECTIONS.values(), SIMPLE_PSM]
    printed = np.vstack([read_printed_rows(), read_printed_rows()[PSM]])
    rows = [
        (
            name,
            head,
            *(
                f"{values[i, column]:.{4 if column < 2 else 2}f}"
                for values in (printed, *compute_first_figures(found).values())
            ),
        )
        for column, head in enumerate(COLUMNS)
        for i, name in enumerate(names)
    ]
    caption = f"Maps of {RESOLUTIONS[0]}² texels."
    return Table(("projection", "score", "printed", *found), rows, caption)


def make_view_table(found):
    """Return a table of texture use and aliasing by view, means of both lights."""
    rows = [
        (
            scene,
            name,
            *(f"{use:.3f} / {aliasing:.1f}" for use, aliasing in scores[:, :, 0, i].mean(axis=1)),
        )
        for scene, scores in found.items()
        for i, name in enumerate([*PROJECTIONS.values(), SIMPLE_PSM])
    ]
    caption = (
        f"Unused share / aliasing [dB] by view, means of both lights; maps of {RESOLUTIONS[0]}² "
        "texels."
    )
    return Table(("scene", "projection", *VIEWS), rows, caption)


def draw_scores(found):
    """Draw both scores as bars."""
    figures = compute_first_figures(found)
    printed = np.vstack([read_printed_rows(), read_printed_rows()[PSM]])
    names = [*map(shorten_name, PROJECTIONS), "PSM, simple"]
    drawn = make_figure(9, 3.6)
    for axes, column in zip(drawn.subplots(1, 2), (0, 2), strict=True):
        sources = {"printed": printed, **figures}
        wide = 0.8 / len(sources)
        for k, ((name, values), colour) in enumerate(zip(sources.items(), COLOURS, strict=False)):
            place = np.arange(len(names)) + k * wide
            axes.bar(place, values[:, column], wide, color=colour, label=name)
        style_axes(axes, "", COLUMNS[column])
        axes.set_xticks(np.arange(len(names)) + 0.3, names)
        axes.tick_params(axis="x", labelrotation=30)
    drawn.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return drawn
