"""Measures the combination of methods that the thesis recommends in section 5: errors and times."""

from itertools import product
from time import process_time

import numpy as np
from brdfkit.theses.ergun2008.views import BIASES, RESOLUTION, View, measure_all

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import UNSTATED, Claim
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 60
SCENES = ()  # names of the scenes to measure; by default all
LISPSM = {"projection": "light_space_perspective"}
PSSM = {"partition": "parallel_split"}
SMALL = {"resolution": RESOLUTION // 2}  # of each of four parts: as many texels as one map has
BLURS = {"none": 0, "5 × 5": 2}
TRIED = dict(list(BIASES.items())[:3])  # the biases by the plane, 5e-4 and 1e-3


def combine_with_variance(blur):
    """Return the techniques with a variance shadow map of a blur, by name."""
    variance = LISPSM | {"filter": "variance", "blur": blur}
    return {
        "LiSPSM + VSM": variance,
        "LiSPSM + VSM + PSSM": variance | PSSM,
        "LiSPSM + VSM + small PSSM": variance | PSSM | SMALL,
    }


PLAIN = {
    "uniform + depth": {"projection": "uniform"},
    "focused + depth": {"projection": "focused"},
    "LiSPSM + depth": LISPSM,
    "LiSPSM + depth + PSSM": LISPSM | PSSM,
}
NAMES = [*PLAIN, *combine_with_variance(0)]
BASE, RECOMMENDED, SPLIT, SMALL_SPLIT = (
    NAMES.index(name)
    for name in (
        "uniform + depth",
        "LiSPSM + VSM",
        "LiSPSM + VSM + PSSM",
        "LiSPSM + VSM + small PSSM",
    )
)
ERROR, PSNR, TIME = range(3)
SETTINGS = "scene", "blur of VSM", "bias"
TEXT = f"""Wrong light where surfaces face it, PSNR against exact shadows, and seconds of CPU to
make the maps and look all pixels up. PSSM has four parts, each of {RESOLUTION} × {RESOLUTION}
texels; *small* PSSM has four of {RESOLUTION // 2} × {RESOLUTION // 2}, as many texels as one map.
Each claim is tried for all scenes × VSM with a blur of 5 × 5 texels and with none × three of the
biases of Table 4."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the recommended combination of methods; return their section."""
    use_variant()
    found = measure_all(measure_techniques, SCENES, report)
    grid = make_grid(found)
    rows = [
        (
            scene,
            name,
            *(
                " / ".join(
                    f"{grid[scene, blur, bias][i, PSNR]:.1f}"
                    for blur in (BLURS if name not in PLAIN else list(BLURS)[:1])
                )
                for bias in TRIED
            ),
            *(
                f"{scale * grid[scene, '5 × 5', next(iter(TRIED))][i, score]:.{digits}f}"
                for score, scale, digits in ((ERROR, 100, 2), (TIME, 1e3, 0))
            ),
        )
        for scene in found
        for i, name in enumerate(NAMES)
    ]
    heads = (
        "scene",
        "technique",
        *(f"bias {bias}" for bias in TRIED),
        "wrong light [%]",
        "time [ms]",
    )
    caption = (
        "PSNR [dB], of VSM without blur / with 5 × 5 texels. The last two columns are by the "
        "receiver's plane, with the blur."
    )
    street = "`street`, view V1: exact shadows, and those by three of the techniques."
    pictures = [Picture("combination", draw_street(), street)]
    claims = [claim_gain(grid), claim_split(grid), claim_small_split(grid), claim_best(grid)]
    return Section("What is recommended", TEXT, claims, [Table(heads, rows, caption)], pictures)


def measure_techniques(view):
    """Return (blurs, techniques, biases, 3): error, PSNR [dB] and CPU seconds in one view."""
    plain = [measure_technique(view, technique) for technique in PLAIN.values()]
    return [
        plain + [measure_technique(view, how) for how in combine_with_variance(blur).values()]
        for blur in BLURS.values()
    ]


def measure_technique(view, technique):
    """Return (biases, 3): the mean error, the PSNR [dB] and the CPU seconds in a view.

    The time is that of the first bias, to make the maps and to look up.
    """
    lits, start = view.compute_lit_by_bias(TRIED.values(), **technique), process_time()
    first = next(lits)
    seconds = process_time() - start
    return [(view.measure_error(lit), view.compute_psnr(lit), seconds) for lit in (first, *lits)]


def make_grid(found):
    """Return the figures (techniques, 3) in each cell: a scene, a blur and a bias.

    Errors and PSNRs are means over views and lights; times are medians, for the first includes the
    time to compile.
    """
    grid = {}
    for scene, cells in found.items():
        means, times = cells.mean(axis=(0, 1)), np.median(cells[..., TIME], axis=(0, 1))
        means[..., TIME] = times
        for (i, bias), (k, blur) in product(enumerate(TRIED), enumerate(BLURS)):
            grid[scene, blur, bias] = means[k, :, i]
    return grid


def judge_gain(grid, better, worse):
    """Return figures and verdict on whether one technique is better than another by PSNR.

    `better` and `worse` are indices of techniques. The figures have the least and the largest gain.
    """
    gains = {cell: values[better, PSNR] - values[worse, PSNR] for cell, values in grid.items()}
    ours, verdict = judge_over_grid(SETTINGS, {cell: bool(g > 0) for cell, g in gains.items()})
    low, high = min(gains.values()), max(gains.values())
    return f"{ours}; {low:+.1f} to {high:+.1f} dB", verdict


def claim_gain(grid):
    ours, verdict = judge_gain(grid, RECOMMENDED, BASE)
    return Claim(
        "LiSPSM + VSM is better than uniform depth maps.",
        "5",
        "the recommendation",
        ours,
        verdict,
    )


def claim_split(grid):
    ours, verdict = judge_gain(grid, SPLIT, RECOMMENDED)
    return Claim(
        "PSSM improves it.",
        "2.2.3, 5",
        "the statement",
        ours,
        verdict,
        "With four maps as large as the one, as the thesis has it: it says that partitions take "
        "more memory and time.",
    )


def claim_small_split(grid):
    ours, _ = judge_gain(grid, SMALL_SPLIT, RECOMMENDED)
    return Claim(
        "PSSM improves it with as many texels in all.",
        "2.2.3",
        "not compared",
        ours,
        UNSTATED,
    )


def claim_best(grid):
    best = {cell: NAMES[int(values[:, PSNR].argmax())] for cell, values in grid.items()}
    ours, verdict = judge_over_grid(SETTINGS, {c: n == NAMES[SPLIT] for c, n in best.items()})
    others = sorted(set(best.values()) - {NAMES[SPLIT]})
    return Claim(
        "LiSPSM + VSM + PSSM comes next to stencil volumes, over all.",
        "5",
        "the recommendation",
        f"{ours}; else {' or '.join(others)}" if others else ours,
        verdict,
        "The best of this table by PSNR. With hard shadows for the truth a blur is what costs; see "
        "Table 4.",
    )


def draw_street():
    """Draw the scene `street` by three techniques."""
    techniques = PLAIN | combine_with_variance(2)
    chosen = "uniform + depth", "LiSPSM + VSM", "LiSPSM + VSM + PSSM"
    return View.load("street", "V1", 1).draw_techniques({name: techniques[name] for name in chosen})
