"""Defines the claims of Table 1 on six projections of shadow maps, by their scores.

`grid` maps each cell, a scene, a size of the map and a form of PSM, to scores (view, light,
projection, 2): the unused share and the aliasing [dB].
"""

from itertools import combinations

import numpy as np
from brdfkit.theses.ergun2008.printed import average_cells, read_printed_table
from brdfkit.theses.ergun2008.views import PROJECTIONS

from brdfkit.theses.claims import Claim
from brdfkit.theses.grid import judge_over_grid

SETTINGS = "scene", "map", "PSM"
FITTED, SIMPLE = "fitted", "simple"  # the forms of PSM
PARTED = 1.0  # dB: projections whose aliasing is closer count as equal
UNIFORM, FOCUSED, PSM, LISPSM, TSM, POSM = range(6)
FORMS = (
    "Of the author's PSM the thesis says only that its light's view may be opened to the whole "
    "cube, symmetric about its middle: that is the simple form. brdfkit's is fitted on each side, "
    "and begins where something is seen."
)


def read_printed_rows():
    return np.array(list(read_printed_table("table_1").values()))


def shorten_name(name):
    words = PROJECTIONS[name]
    return words.partition("(")[2].rstrip(")") or words


def compute_figures(scores):
    """Return the row of Table 1 of each projection (n, 4) from scores (view, light, n, 2)."""
    return np.array(
        [
            [*average_cells(scores[..., i, 0]), *average_cells(scores[..., i, 1])]
            for i in range(scores.shape[-2])
        ]
    )


def judge_figures(grid, holds, with_psm=True):
    """Return figures and verdict on a condition of the figures (6, 4) in the cells of a grid.

    Both forms of PSM are tried only if the condition is about it, `with_psm`.
    """
    return judge(grid, lambda scores: holds(compute_figures(scores)), with_psm)


def judge(grid, holds, with_psm=True):
    """Return figures and verdict on a condition of the scores in the cells of a grid."""
    names = SETTINGS if with_psm else SETTINGS[:-1]
    tried = {
        cell[: len(names)]: bool(holds(scores))
        for cell, scores in grid.items()
        if with_psm or cell[2] == FITTED
    }
    return judge_over_grid(names, tried)


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
    kept = [count_kept(compute_figures(scores)) for scores in grid.values()]
    order = np.argsort(-sign * read_printed_rows()[:, column], kind="stable")
    return Claim(
        says,
        "Table 1, 5",
        " > ".join(shorten_name(list(PROJECTIONS)[i]) for i in order),
        f"{ours}; {min(kept)} to {max(kept)} of {len(pairs)} pairs as printed",
        verdict,
        why,
    )


def claim_extreme(says, grid, column, sign, projection, why, with_psm=True):
    """Claim that a projection has the largest value of a column, times `sign`."""
    ours, verdict = judge_figures(
        grid, lambda figures: np.argmax(sign * figures[:, column]) == projection, with_psm
    )
    printed = f"{read_printed_rows()[projection, column]:g}"
    return Claim(says, "Table 1", printed, ours, verdict, why)


def claim_focus(grid):
    ours, verdict = judge_figures(grid, lambda f: f[FOCUSED, 0] < f[UNIFORM, 0], with_psm=False)
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
    ours, verdict = judge_figures(grid, lambda f: measure_spread(f) < PARTED, with_psm=False)
    spreads = [measure_spread(compute_figures(scores)) for scores in grid.values()]
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
        "Table 1",
        "2.03 dB, others 4.36 to 6.76",
        ours,
        verdict,
    )


def claim_steadier(grid):
    ours, verdict = judge_figures(grid, lambda f: f[LISPSM, 3] < f[UNIFORM, 3], with_psm=False)
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
    use = scores[..., 0].mean(axis=1)
    return use[view] < use[other]


def claim_lamp(grid):
    """Claim that maps are used better with the light at the eye, view V4, than in view V1.

    The plane-optimal projection POSM is left out, as in the thesis.
    """
    ours, verdict = judge(grid, lambda scores: compare_use(scores, 3, 0)[:POSM].all())
    return Claim(
        "The miner's lamp, V4, uses maps better than V1, of all projections but POSM.",
        "4.2.2",
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
        "4.2.2",
        "6 of 6 projections",
        ours,
        verdict,
    )
