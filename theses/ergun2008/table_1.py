"""Reproduces Table 1, the texture use and the aliasing of six projections of shadow maps."""

from itertools import product

import numpy as np
from brdfkit.theses.ergun2008 import projection_claims as claims
from brdfkit.theses.ergun2008.projection_claims import (
    FOCUSED,
    LISPSM,
    NEARS,
    OURS,
    POSM,
    PSM,
    THESIS,
    TSM,
    UNIFORM,
    WINDOWS,
    Scores,
    read_printed_rows,
    shorten_name,
)
from brdfkit.theses.ergun2008.thesis_forms import BY_NEAR, make_window, score_projection
from brdfkit.theses.ergun2008.views import PROJECTIONS, measure_all

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.shadows.comparison.scoring import score_texels
from brdfkit.shadows.maps.scenes import VIEWS
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 75
SCENES = ()  # names of the scenes to measure; by default all
RESOLUTIONS = 512, 1024
COLUMNS = "unused, Q1", "relative", "aliasing, Q2 [dB]", "relative [dB]"
# The forms of the thesis, after our six: (projection, whose window or near plane)
THEIRS = [(UNIFORM, window) for window in WINDOWS]
THEIRS += [(i, near) for near in NEARS for i in (PSM, LISPSM, TSM)]
NAMES = [
    *PROJECTIONS.values(),
    *(f"uniform, {THESIS} ({window})" for window in WINDOWS),
    *(f"{PROJECTIONS[name]}, {THESIS} ({near})" for near in NEARS for name in BY_NEAR),
]
TEXT = f"""The thesis takes Q1 as the mean squared error of a histogram, of an untold unit; here it
is the share of the map that is *not* used, d / (1 + d), where d is that error over the square of
the histogram's mean: from 0 to 1, and small is good, as there. Q2 is the PSNR of the texels' areas
[pixels] as grey levels against black. Both depend on resolutions, which the thesis does not
tell. Four projections have two *forms*, *ours* and *the thesis's*:

- uniform: ours encloses the scene. The thesis had the default of the engine Ogre, a window that is
  twice as wide as the distance of shadows.
- PSM: ours is fitted on each side, and begins at the nearest surface. The thesis's opens the
  light's view evenly to all corners of the unit cube.
- LiSPSM: ours has the n of its authors, for any angle of the light. The thesis had Ogre's, n as for
  a right angle, times 0.1, and weaker where view and light are nearly parallel.
- TSM: our trapezoid is about all that is seen and what casts shadows on it. The thesis's is about
  the camera's frustum, on the uniform map.

Focused and plane-optimal maps are of one form. Verdicts are on the thesis's forms; ours are beside
them. Each claim is tried for all scenes × maps of {" and ".join(f"{n}²" for n in RESOLUTIONS)}
texels × two untold settings of the thesis's forms: *window*, the distance of shadows, is
{" or ".join(WINDOWS)} of the farthest depth that is seen, and *near plane*, the eye's, is at
{" or ".join(NEARS)} of the distance of the nearest surface. A number in brackets is that of the
window or of the near plane."""


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
    posm, psm, forms = claims.POSM, claims.PSM, claims.FORM_OF_PSM
    made = [
        claims.claim_order("Texture use, best first.", grid, 0, -1, 0.0, one_scene),
        claims.claim_extreme("POSM uses the map best.", grid, 0, -1, posm, plane),
        claims.claim_extreme("PSM uses it worst.", grid, 0, 1, psm, forms),
        claims.claim_focus(grid),
        claims.claim_order("Aliasing, least first.", grid, 2, 1, claims.PARTED, order),
        claims.claim_extreme("POSM has the least aliasing.", grid, 2, 1, posm, plane),
        claims.claim_extreme("PSM has the most.", grid, 2, -1, psm, forms),
        claims.claim_even(grid),
        claims.claim_steadiest(grid),
        claims.claim_steadier(grid),
        claims.claim_lamp(grid),
        claims.claim_dueling(grid),
    ]
    tables = [make_scene_table(found), make_view_table(found)]
    caption = (
        f"Table 1, printed, and ours with maps of {RESOLUTIONS[0]}² texels. Those with a number in "
        "brackets have the thesis's form."
    )
    pictures = [Picture("table_1", draw_scores(found), caption)]
    return Section("Table 1: projections", TEXT, made, tables, pictures)


def score_projections(view):
    """Return scores (maps, projections, 2) in a view: the unused share and the aliasing [dB].

    The projections are those of `NAMES`.
    """
    theirs = [make_window(view.placement, far) for far in WINDOWS.values()]
    theirs += [make(view.placement, n) for n in NEARS.values() for make in BY_NEAR.values()]
    found = []
    for resolution in RESOLUTIONS:
        shadows = [view.make_shadow(projection=p, resolution=resolution) for p in PROJECTIONS]
        scores = [score_texels(shadow, view.seen, view.placement) for shadow in shadows]
        rows = [(1 - use, aliasing) for use, aliasing in scores]
        found.append([*rows, *(score_projection(view, each, resolution) for each in theirs)])
    return found


def make_grid(found):
    """Return the `Scores` of six projections by form, and by the values of its settings."""
    grid = {OURS: {}, THESIS: {}}
    places = {its: len(PROJECTIONS) + place for place, its in enumerate(THEIRS)}
    for (scene, scores), (k, resolution) in product(found.items(), enumerate(RESOLUTIONS)):
        cell = scene, f"{resolution}²"
        grid[OURS][cell] = Scores(scores[:, :, k, : len(PROJECTIONS)])
        for window, near in product(WINDOWS, NEARS):
            uniform, psm, lispsm, tsm = (
                places[its] for its in ((UNIFORM, window), *((i, near) for i in (PSM, LISPSM, TSM)))
            )
            chosen = [uniform, FOCUSED, psm, lispsm, tsm, POSM]
            grid[THESIS][*cell, window, near] = Scores(scores[:, :, k, chosen])
    return grid


def repeat_printed_rows():
    """Return the printed rows for `NAMES`: those of the thesis's forms are the same again."""
    printed = read_printed_rows()
    return np.vstack([printed, *(printed[i] for i, _ in THEIRS)])


def compute_first_figures(found):
    """Return the rows of Table 1 (projections, 4) by scene, with the first size of maps."""
    return {scene: Scores(scores[:, :, 0]).figures for scene, scores in found.items()}


def make_scene_table(found):
    """Return Table 1, printed and of each scene."""
    printed = repeat_printed_rows()
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
        for i, name in enumerate(NAMES)
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
        for i, name in enumerate(NAMES)
    ]
    caption = (
        f"Unused share / aliasing [dB] by view, means of both lights; maps of {RESOLUTIONS[0]}² "
        "texels."
    )
    return Table(("scene", "projection", *VIEWS), rows, caption)


def draw_scores(found):
    """Draw both scores as bars."""
    figures = compute_first_figures(found)
    printed = repeat_printed_rows()
    names = [*map(shorten_name, PROJECTIONS), *(f"uniform ({window})" for window in WINDOWS)]
    names += [f"{shorten_name(name)} ({near})" for near in NEARS for name in BY_NEAR]
    drawn = make_figure(13, 4.2)
    for axes, column in zip(drawn.subplots(1, 2), (0, 2), strict=True):
        sources = {"printed": printed, **figures}
        wide = 0.8 / len(sources)
        for k, ((name, values), colour) in enumerate(zip(sources.items(), COLOURS, strict=False)):
            place = np.arange(len(names)) + k * wide
            axes.bar(place, values[:, column], wide, color=colour, label=name)
        style_axes(axes, "", COLUMNS[column])
        axes.set_xticks(np.arange(len(names)) + 0.3, names)
        axes.tick_params(axis="x", labelrotation=60)
    drawn.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return drawn
