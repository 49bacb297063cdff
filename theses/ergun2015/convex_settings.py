"""Varies the settings of convex shadows: the allowed concavity, the maps' size, the clearance."""

from itertools import pairwise

from brdfkit.theses.ergun2015.convex_study import (
    EPSILON,
    NO_COACD,
    PRINTED_FORM,
    SETTING,
    can_decompose,
    make_swept_study,
)
from brdfkit.theses.ergun2015.printed_ray import PrintedOccluders

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.lighting.visibility.occluders import Occluders
from brdfkit.theses.claims import NOT_RUN, Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table
from brdfkit.theses.timing import compare_times, measure_in_turns

SECONDS = 60
CONCAVITIES = 0.02, 0.03, 0.05, 0.1, 0.2, 0.4
RESOLUTIONS = 8, 16, 32, 64, 128, 256
CLEARANCES = 0.0, 0.005, 0.01, 0.02, 0.03, 0.04
TURNS = 11  # measurements of each time
TITLE = "Settings of convex shadows"
FEWER = "The larger the concavity, the fewer the parts.", "Figure 9.8", "fewer"
FASTER = (
    "The larger the concavity, the higher the frame rate: brdfkit's form.",
    "Figure 9.8",
    "a drawing",
)
PRINTED, WITHOUT, OURS = "printed", "without clearance", "brdfkit"
TEXT = f"""{SETTING} The concavity is the largest distance between a part and its hull. *Clearance*:
a part that a ray enters nearer than this, over half of the mesh's longest side, does not shade; the
thesis has none. {PRINTED_FORM}"""


@in_turn
def check_claims(sources, report):
    """Check the claims on the settings of convex shadows; return their section of the page."""
    use_variant()
    if not can_decompose():
        missing = Claim(*FEWER, "", NOT_RUN, NO_COACD, arithmetic=True)
        return Section(TITLE, TEXT, [missing, Claim(*FASTER, "", NOT_RUN, NO_COACD)])
    name, study = make_swept_study(sources)
    steps, done = 3 * len(CONCAVITIES) + len(RESOLUTIONS) + len(CLEARANCES), 0

    def measure_psnr(occluders):
        nonlocal done
        done += 1
        report(done, steps)
        return study.compute_quality(occluders)[0]

    parts = {c: study.decompose_mesh(concavity=c) for c in CONCAVITIES}
    clear = {c: Occluders({"mesh": p}) for c, p in parts.items()}
    seconds = measure_in_turns(
        {c: lambda by=by: study.render(by) for c, by in clear.items()}, TURNS
    )
    by = {
        PRINTED: [measure_psnr(PrintedOccluders({"mesh": p}, EPSILON)) for p in parts.values()],
        WITHOUT: [measure_psnr(Occluders({"mesh": p}, clearance=0)) for p in parts.values()],
        OURS: [measure_psnr(occluders) for occluders in clear.values()],
    }
    usual = study.decompose_mesh()
    sides = [measure_psnr(Occluders({"mesh": usual}, resolution=side)) for side in RESOLUTIONS]
    lengths = [measure_psnr(Occluders({"mesh": usual}, clearance=c)) for c in CLEARANCES]

    counts = [len(p) for p in parts.values()]
    relative = [compare_times(seconds[c], seconds[CONCAVITIES[0]]) for c in CONCAVITIES]
    found = zip(CONCAVITIES, counts, relative, *by.values(), strict=True)
    rows = [(f"{c:g}", str(n), str(t), *(f"{p:.1f}" for p in each)) for c, n, t, *each in found]
    heads = "concavity", "parts", "CPU time", *(f"{label} [dB]" for label in by)
    tables = [
        Table(heads, rows, f"Of {name}; times over that of the first row."),
        make_row_table("texels of a map", RESOLUTIONS, sides),
        make_row_table("clearance", CLEARANCES, lengths),
    ]
    claims = [claim_fewer(counts), claim_faster(relative)]
    picture = Picture("convex_settings", draw_curves(by, counts))
    return Section(TITLE, TEXT, claims, tables, [picture])


def make_row_table(label, settings, decibels):
    """Return a table of one row: PSNR by setting."""
    row = "PSNR [dB]", *(f"{x:.1f}" for x in decibels)
    return Table((label, *(f"{s:g}" for s in settings)), [row])


def claim_fewer(counts):
    """Claim that a mesh has fewer convex parts if more concavity is allowed."""
    falling = all(a > b for a, b in pairwise(counts))
    ours, why = " ".join(map(str, counts)), "The decomposition stops where this limit is kept."
    return Claim(*FEWER, ours, to_verdict(falling), why, arithmetic=True)


def claim_faster(relative):
    """Claim that pictures take less time if more concavity is allowed than the least.

    `relative` are ratios of times to that at the least concavity.
    """
    cells = {(f"{c:g}",): by.high < 1 for c, by in zip(CONCAVITIES[1:], relative[1:], strict=True)}
    ours, verdict = judge_over_grid(("concavity",), cells)
    return Claim(
        *FASTER,
        f"{ours}; the largest takes {relative[-1]} times as long as the least",
        verdict,
        "Seconds of CPU in one thread, in turns, with 95 % intervals: a concavity counts where the "
        "whole interval is below the time of the least. Neighbours are not compared. The parts' "
        "time is not all of a picture's.",
    )


def draw_curves(by, counts):
    """Draw PSNR and number of parts over the concavity."""
    drawn = make_figure(7.6, 2.8)
    left, right = drawn.subplots(1, 2)
    for (label, decibels), colour in zip(by.items(), COLOURS, strict=False):
        left.semilogx(CONCAVITIES, decibels, "o-", color=colour, label=label)
    left.legend(frameon=False)
    style_axes(left, "quality", "PSNR [dB]")
    right.loglog(CONCAVITIES, counts, "o-", color=COLOURS[-1])
    style_axes(right, "parts", "number of parts")
    for axes in (left, right):
        axes.set_xlabel("concavity")
        axes.set_xticks(CONCAVITIES, [f"{c:g}" for c in CONCAVITIES])
        axes.minorticks_off()
    return drawn
