"""Reproduces Table 7.1, the time of an iteration by renderer, volume size and frame size."""

from contextlib import contextmanager, nullcontext
from itertools import count

import numpy as np
from brdfkit.theses.lesar2018.iterations import make_cloud, make_renderer, make_stage
from brdfkit.theses.lesar2018.renderers import RENDERERS

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import NOT_RUN, UNSTATED, Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table
from brdfkit.theses.timing import ALIKE, compare_times, measure_in_turns
from brdfkit.volumes.rays import search

SECONDS = 60
VOXELS, FRAMES = (64, 128, 256), (256, 512, 1024)
MIDDLE = 128, 512  # voxels and pixels of the cell to which other times are compared
TURNS = 5
PRINTED = {  # ms, by (voxels, frame)
    "phone": {(64, 512): 28, (128, 512): 65, (256, 512): 92, (128, 256): 35, (128, 1024): 98},
    "laptop": {(64, 512): 16, (128, 512): 28, (256, 512): 45, (128, 256): 16, (128, 1024): 55},
}
NAMES = {
    "maximum_intensity": "Maximum intensity",
    "single_scattering": "The radiative transfer equation",
}
TIED = 1.1  # two renderers count as equally fast within this factor
WHY_RANKED = f"""Judged by the plain maximum, as the thesis has it; its steps of a ray are not
printed. Ours leave empty cells out, and scattering is one collision of a ray. Within
{100 * (TIED - 1):.0f} % two are tied."""
RATE = 20  # iterations per second that the thesis claims
LOOKUPS = 20, 64, 256  # steps of a ray in the settings in which the renderers are ranked
TEXT = f"""Smoke by each renderer, one ray per pixel in an iteration. The thesis does not say which
renderer its table is of, nor the steps of any; here the march takes 128 steps, the others 256. Ours
are seconds of CPU in one thread over those of the middle cell, as the printed ones; 16 ms is the
least that a browser shows. What is compared takes turns, {TURNS} each, and a verdict needs the
whole 95 % interval of a ratio. In the middle cell the renderers are ranked with
{", ".join(map(str, LOOKUPS))} steps of each ray, and maximum intensity with the search about the
largest value that brdfkit adds, and without, as in the thesis. Scattering takes no steps."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the time of an iteration; return their section of the page."""
    use_variant()
    cells, seconds, ranked = list(PRINTED["phone"]), {}, {}
    for name in RENDERERS:
        seconds[name] = measure_in_turns(
            {cell: prepare_iteration(name, *cell) for cell in cells}, TURNS
        )
        report(len(seconds), len(RENDERERS) + len(LOOKUPS))
    for steps in LOOKUPS:
        ranked |= time_renderers(steps)
        report(len(RENDERERS) + len(ranked) // 2, len(RENDERERS) + len(LOOKUPS))
    medians = {n: {c: np.median(t) for c, t in by_cell.items()} for n, by_cell in seconds.items()}
    lines = [
        *((f"{n}, printed", t, f"{t[MIDDLE]} ms") for n, t in PRINTED.items()),
        *((n, t, f"{1e3 * t[MIDDLE]:.0f} ms") for n, t in medians.items()),
    ]
    rows = [(name, *(f"{t[c] / t[MIDDLE]:.2f}" for c in cells), said) for name, t, said in lines]
    heads = "", *(f"{v}³, {f}²" for v, f in cells), "middle"
    caption = f"Times over those of {MIDDLE[0]}³ voxels in a frame of {MIDDLE[1]}²."
    claims = [
        *claim_ranking(ranked),
        claim_voxels(seconds),
        claim_pixels(seconds),
        *claim_rates(),
    ]
    tables = [Table(heads, rows, caption), tabulate_ranking(ranked)]
    return Section("Times of an iteration", TEXT, claims, tables)


def time_renderers(steps):
    """Return the CPU seconds (turns,) of an iteration by each renderer, with `steps` of a ray.

    They are in a dictionary by the number of steps and the kind of maximum, without and with a
    search about the largest value.
    """
    found = {}
    for maximum, searching in (("plain", stop_refining()), ("refined", nullcontext())):
        with searching:
            found[str(steps), maximum] = measure_in_turns(
                {name: prepare_iteration(name, *MIDDLE, steps) for name in RENDERERS}, TURNS
            )
    return found


@contextmanager
def stop_refining():
    """Let maximum intensity take the largest value of its points, without a search about it."""
    before = search.HALVINGS
    search.HALVINGS = 0
    try:
        yield
    finally:
        search.HALVINGS = before


def tabulate_ranking(ranked):
    """Return a table of the times of the renderers in each setting [ms]."""
    rows = [
        (*setting, *(f"{1e3 * np.median(times[name]):.0f}" for name in RENDERERS))
        for setting, times in ranked.items()
    ]
    heads = "steps", "maximum", *RENDERERS
    return Table(heads, rows, "CPU time of an iteration [ms], in the middle cell.")


def prepare_iteration(renderer, voxels, frame, steps=None):
    """Return a function that does an iteration by a renderer, by the sizes of volume and frame."""
    described = make_cloud(renderer, voxels)
    takes_steps = steps and renderer != "single_scattering"
    scene = make_stage(described | ({"steps": steps} if takes_steps else {}), frame)
    seeds, render = count(1), make_renderer()
    return lambda: render(scene, next(seeds)).numpy()


def claim_ranking(ranked):
    """Claim which of the four renderers is the fastest, and which the slowest.

    One that is as fast as another within the factor `TIED`, by the interval of the ratio of their
    times, is neither.
    """

    def is_first(name, times):
        return all(compare_times(times[n], times[name]).low > TIED for n in times if n != name)

    def is_last(name, times):
        return all(compare_times(times[name], times[n]).low > TIED for n in times if n != name)

    claims = []
    for name, what, holds in (
        ("maximum_intensity", "the fastest", is_first),
        ("single_scattering", "the slowest", is_last),
    ):
        found = {(n,): holds(name, ranked[n, "plain"]) for n in map(str, LOOKUPS)}
        ours, verdict = judge_over_grid(("number of steps",), found)
        says = f"{NAMES[name]} is {what} of the four renderers."
        claims.append(Claim(says, "ch. 7", "no figure", ours, verdict, WHY_RANKED))
    return claims


def claim_voxels(seconds):
    """Claim how much longer a larger volume takes."""
    small, large = (64, 512), (256, 512)
    printed, found = compare_cells(seconds, small, large)
    low, high = min(printed.values()), max(printed.values())
    return Claim(
        "64 times the voxels take about three times as long.",
        "Table 7.1",
        write_printed(printed),
        ", ".join(f"{ratio.value:.1f} times by {name}" for name, ratio in found.items()),
        judge_over_grid(
            ("renderer",),
            {(n,): r.is_at_least(low) and r.is_at_most(high) for n, r in found.items()},
        )[1],
        f"Geometric means of pairs; it holds within a factor of {ALIKE:g} of what is printed. The "
        "thesis does not say which renderer its table is of; its words suggest scattering. All "
        "times grow far more slowly than the voxels.",
    )


def claim_pixels(seconds):
    """Say how much longer a larger frame takes, which asks for a graphics chip."""
    printed, found = compare_cells(seconds, (128, 256), (128, 1024))
    ratios = [ratio.value for ratio in found.values()]
    return Claim(
        "16 times the pixels take about three times as long.",
        "Table 7.1",
        write_printed(printed),
        f"{min(ratios):.0f} to {max(ratios):.0f} times, on a processor",
        NOT_RUN,
        "On a processor times grow with the pixels. Whether small frames leave parts of a graphics "
        "chip idle, as the printed times suggest, cannot be tried here.",
    )


def compare_cells(seconds, small, large):
    """Return the ratios of times of two cells of the table: printed by chip, ours by renderer."""
    printed = {name: times[large] / times[small] for name, times in PRINTED.items()}
    return printed, {n: compare_times(times[large], times[small]) for n, times in seconds.items()}


def write_printed(ratios):
    """Write the printed ratios, of which the laptop's are by a time that its browser holds up."""
    return f"{ratios['phone']:.1f} times on a phone, at least {ratios['laptop']:.1f} on a laptop"


def claim_rates():
    """Claim that the printed times allow the printed rates."""
    times = [t for by_cell in PRINTED.values() for t in by_cell.values()]
    claims = []
    for says, where, rate, verdict, why in (
        (
            f"{RATE} iterations per second and more, also on mobile.",
            "ch. 7",
            RATE,
            UNSTATED,
            "The thesis says so of its setting of speed, and not whether the table has it.",
        ),
        (
            "All methods reach more than 10 iterations per second on both devices.",
            "ch. 8",
            10,
            to_verdict(max(times) < 100),
            "By the thesis's own table, of one renderer.",
        ),
    ):
        reached = sum(t <= 1000 / rate for t in times)
        ours = (
            f"{reached} of the {len(times)} printed times allow {rate}, "
            f"the slowest {1000 / max(times):.1f}"
        )
        claims.append(Claim(says, where, "Table 7.1", ours, verdict, why, arithmetic=True))
    return claims
