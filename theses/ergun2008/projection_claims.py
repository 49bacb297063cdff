"""Defines the claims of Table 1 on six projections of shadow maps, by their scores.

`grid` holds the `Scores` of the six projections in each cell: by form, ours or the thesis's, and
then by the values of its settings, see `SETTINGS`. Verdicts are on the thesis's forms.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from brdfkit.theses.ergun2008.printed import average_cells, read_printed_table
from brdfkit.theses.ergun2008.views import PROJECTIONS

from brdfkit.theses.claims import Claim
from brdfkit.theses.grid import judge_over_grid

OURS, THESIS = "ours", "the thesis's"  # the forms
SETTINGS = {OURS: ("scene", "map"), THESIS: ("scene", "map", "window", "near plane")}
WINDOWS = {"1": 1.0, "½": 0.5}  # distance of shadows over the farthest depth that is seen
NEARS = {"0.1": 0.1, "1": 1.0}  # distance of the eye's near plane over the nearest surface's
EQUAL = 0.001  # of the map: uses of it that are closer count as equal
PARTED = 1.0  # dB: projections whose aliasing is closer count as equal
UNIFORM, FOCUSED, PSM, LISPSM, TSM, POSM = range(6)
FORM_OF_PSM = (
    "The thesis's PSM opens the light's view to the whole cube, evenly about its middle; ours is "
    "fitted on each side, and begins where something is seen."
)


def read_printed_rows():
    return np.array(list(read_printed_table("table_1").values()))


def shorten_name(name):
    words = PROJECTIONS[name]
    return words.partition("(")[2].rstrip(")") or words


@dataclass(frozen=True)
class Scores:
    """The unused share and the aliasing [dB] of projections, in all views and lights of a scene.

    values : the scores (view, light, projection, 2).
    """

    values: np.ndarray

    @cached_property
    def figures(self):
        """The row of Table 1 of each projection (n, 4)."""
        columns = [(i, score) for i in range(self.values.shape[2]) for score in (0, 1)]
        means = [average_cells(self.values[..., i, score]) for i, score in columns]
        return np.reshape(means, (-1, 4))


def judge_figures(grid, holds):
    """Return figures and verdict on a condition of the figures (6, 4) in the cells of a grid."""
    return judge(grid, lambda scores: holds(scores.figures))


def judge(grid, holds, settings=SETTINGS):
    """Return figures and verdict on a condition of what the cells of a grid hold.

    The verdict is on the thesis's forms; the figures are also those of ours.

    settings : the names of the settings by form.
    """
    found = {
        form: judge_over_grid(names, {cell: bool(holds(its)) for cell, its in grid[form].items()})
        for form, names in settings.items()
    }
    (own, own_verdict), (its, verdict) = found[OURS], found[THESIS]
    return f"by the thesis's forms {its}; by ours {own} ({own_verdict})", verdict


def list_scores(grid):
    """Return the `Scores` of all cells, of both forms."""
    return [scores for cells in grid.values() for scores in cells.values()]


def list_printed_pairs(column, sign, parted):
    """Return the pairs (better, worse) of projections that are printed at least `parted` apart.

    sign : 1 where more is better, else -1.
    """
    better = sign * read_printed_rows()[:, column]
    pairs = [sorted(pair, key=lambda i: -better[i]) for pair in combinations(range(6), 2)]
    return [(a, b) for a, b in pairs if better[a] - better[b] >= parted]


def claim_order(says, grid, column, sign, parted, why):
    """Claim that the order of projections is the printed one, where they are `parted`."""
    pairs = list_printed_pairs(column, sign, parted)

    def count_kept(figures):
        better = sign * figures[:, column]
        return sum(better[a] > better[b] for a, b in pairs)

    ours, verdict = judge_figures(grid, lambda figures: count_kept(figures) == len(pairs))
    kept = [count_kept(scores.figures) for scores in list_scores(grid)]
    order = np.argsort(-sign * read_printed_rows()[:, column], kind="stable")
    return Claim(
        says,
        "Table 1, 5",
        " > ".join(shorten_name(list(PROJECTIONS)[i]) for i in order),
        f"{ours}; {min(kept)} to {max(kept)} of {len(pairs)} pairs as printed",
        verdict,
        why,
    )


def claim_extreme(says, grid, column, sign, projection, why):
    """Claim that a projection has the largest value of a column, times `sign`."""
    ours, verdict = judge_figures(
        grid, lambda figures: np.argmax(sign * figures[:, column]) == projection
    )
    printed = f"{read_printed_rows()[projection, column]:g}"
    return Claim(says, "Table 1", printed, ours, verdict, why)


def claim_focus(grid):
    ours, verdict = judge_figures(grid, lambda f: f[FOCUSED, 0] < f[UNIFORM, 0] - EQUAL)
    return Claim(
        "Focusing makes better use of the map than the uniform projection.",
        "2.2.2.1",
        "the statement; but Table 1 has 0.2650 and 0.2302",
        ours,
        verdict,
        "A map of less, of which the same is seen, is used more. The printed table says the "
        "opposite of its section.",
    )


def measure_spread(figures):
    """Return how far the aliasing of uniform, focused and LiSPSM is apart [dB]."""
    return np.ptp(figures[[UNIFORM, FOCUSED, LISPSM], 2])


def claim_even(grid):
    ours, verdict = judge_figures(grid, lambda f: measure_spread(f) < PARTED)
    spreads = [measure_spread(scores.figures) for scores in list_scores(grid)]
    return Claim(
        "Uniform, focused and LiSPSM hardly differ by aliasing.",
        "Table 1, 5",
        "30.50 to 30.56 dB",
        f"{ours}; {min(spreads):.1f} to {max(spreads):.1f} dB apart",
        verdict,
        f"Below {PARTED:g} dB. The printed mean of LiSPSM is lifted by one cell, 51.03 dB; without "
        "V4 it is 26.85 dB. What is seen of a deep scene is a small part of a uniform map.",
    )


def claim_steadiest(grid):
    ours, verdict = judge_figures(grid, lambda f: np.argmin(f[:, 3]) == PSM)
    return Claim(
        "PSM's aliasing changes least from light to light, though it is the worst.",
        "cells of Table 1",
        "2.03 dB, others 4.36 to 6.76",
        ours,
        verdict,
    )


def claim_steadier(grid):
    ours, verdict = judge_figures(grid, lambda f: f[LISPSM, 3] < f[UNIFORM, 3])
    return Claim(
        "LiSPSM's aliasing changes less from light to light than the uniform one's.",
        "5",
        "5.81 and 6.70 dB",
        ours,
        verdict,
        "A reason of the thesis to recommend it.",
    )


def compare_use(scores, view, other):
    """Return of which projections (6,) a view uses the map better than another view."""
    use = scores.values[..., 0].mean(axis=1)
    return use[view] < use[other]


def claim_lamp(grid):
    """Claim that maps are used better with the light at the eye, view V4, than in view V1.

    The plane-optimal projection POSM is left out, as in the thesis.
    """
    ours, verdict = judge(grid, lambda scores: compare_use(scores, 3, 0)[:POSM].all())
    return Claim(
        "The miner's lamp, V4, uses maps better than V1, of all projections but POSM.",
        "cells of 4.2.2",
        "5 of 5",
        ours,
        verdict,
        "Where the map holds the whole scene, the view decides little.",
    )


def claim_dueling(grid):
    """Claim that view V3 uses maps less than V2, which looks into the light."""
    ours, verdict = judge(grid, lambda scores: compare_use(scores, 1, 2).all())
    return Claim(
        "V3, which is called intermediate, uses maps less than V2, the worst case by name.",
        "cells of 4.2.2",
        "6 of 6 projections",
        ours,
        verdict,
    )
