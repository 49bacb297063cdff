"""Reproduces Table 7.1, the time of an iteration by renderer, volume size and frame size."""

from contextlib import contextmanager, nullcontext

from brdfkit.theses.lesar2018.iterations import make_cloud, make_renderer, make_stage
from brdfkit.theses.lesar2018.renderers import RENDERERS

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, measure_least_seconds, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table
from brdfkit.volumes.rays import search

SECONDS = 60
VOXELS, FRAMES = (64, 128, 256), (256, 512, 1024)
MIDDLE = 128, 512  # voxels and pixels of the cell to which other times are compared
TIMES = 3
PRINTED = {  # ms, by (voxels, frame)
    "phone": {(64, 512): 28, (128, 512): 65, (256, 512): 92, (128, 256): 35, (128, 1024): 98},
    "laptop": {(64, 512): 16, (128, 512): 28, (256, 512): 45, (128, 256): 16, (128, 1024): 55},
}
CLOSE = 1.5  # two ratios count as equal within this factor
NAMES = dict.fromkeys(RENDERERS, "") | {
    "maximum_intensity": "Maximum intensity",
    "single_scattering": "The radiative transfer equation",
}
WHY_RANKED = """Theirs may look fewer points up in an iteration. Ours leave empty cells out, and
scattering is one collision of a ray."""
RATE = 20  # iterations per second that the thesis claims
LOOKUPS = 20, 64, 256  # steps of a ray in the settings in which the renderers are ranked
TEXT = f"""Smoke by each renderer, one ray per pixel in an iteration, the least of {TIMES}. The
thesis does not say which renderer its table is of, nor the steps of any; here the march takes 128
steps, the others 256. Ours are seconds of CPU, of all cores together, over those of the middle
cell, as the printed ones; 16 ms is the least that a browser shows. In that cell the renderers are
ranked with {", ".join(map(str, LOOKUPS))} steps of each ray, and maximum intensity with the search
about the largest value that brdfkit adds, and without, as in the thesis. Scattering takes no
steps."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the time of an iteration; return their section of the page."""
    use_variant()
    cells = list(PRINTED["phone"])
    seconds, total = {}, len(cells) * len(RENDERERS) + len(LOOKUPS) * 4
    for name in RENDERERS:
        for cell in cells:
            seconds[name, cell] = measure_iteration(name, *cell)
            report(len(seconds), total)
    printed = {name: divide_by_middle(times) for name, times in PRINTED.items()}
    ours = {name: divide_by_middle({c: seconds[name, c] for c in cells}) for name in RENDERERS}
    rows = [
        (name, *(f"{times[c]:.2f}" for c in cells), said)
        for name, times, said in [
            *((f"{n}, printed", t, f"{PRINTED[n][MIDDLE]} ms") for n, t in printed.items()),
            *((n, t, f"{1e3 * seconds[n, MIDDLE]:.0f} ms") for n, t in ours.items()),
        ]
    ]
    heads = "", *(f"{v}³, {f}²" for v, f in cells), "middle"
    caption = f"Times over those of {MIDDLE[0]}³ voxels in a frame of {MIDDLE[1]}²."
    scattering = seconds["single_scattering", MIDDLE]
    ranked = {}
    for steps in LOOKUPS:
        ranked |= rank_renderers(steps, scattering)
        report(len(cells) * len(RENDERERS) + 4 * len(ranked) // 2, total)
    claims = [
        *claim_ranking(ranked),
        claim_growth("64 times the voxels", (64, 512), (256, 512), ours),
        claim_growth("16 times the pixels", (128, 256), (128, 1024), ours),
        claim_rate(),
    ]
    tables = [Table(heads, rows, caption), tabulate_ranking(ranked)]
    return Section("Times of an iteration", TEXT, claims, tables)


def rank_renderers(steps, scattering):
    """Return the CPU seconds of an iteration by each renderer, with so many steps of a ray.

    They are in a dictionary by the number of steps and the kind of maximum, without and with a
    search about the largest value. The time of `scattering` does not depend on the steps.
    """
    names = "isosurface", "emission_absorption"
    seconds = {name: measure_iteration(name, *MIDDLE, steps) for name in names}
    seconds["single_scattering"] = scattering
    found = {}
    for maximum, searching in (("plain", stop_refining()), ("refined", nullcontext())):
        with searching:
            largest = measure_iteration("maximum_intensity", *MIDDLE, steps)
        found[str(steps), maximum] = {"maximum_intensity": largest, **seconds}
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
        (*setting, *(f"{1e3 * times[name]:.0f}" for name in RENDERERS))
        for setting, times in ranked.items()
    ]
    heads = "steps", "maximum", *RENDERERS
    return Table(heads, rows, "CPU time of an iteration [ms], in the middle cell.")


def measure_iteration(renderer, voxels, frame, steps=None):
    """Return the CPU seconds of an iteration, by a renderer and sizes of volume and frame."""
    described = make_cloud(renderer, voxels)
    scene = make_stage(described | ({"steps": steps} if steps else {}), frame)
    seeds, render = iter(range(1, 100)), make_renderer()

    def once():
        render(scene, next(seeds)).numpy()

    once()  # compiles the kernels, which is not timed
    once()  # records the rendering, which later calls replay
    return measure_least_seconds(once, times=TIMES)


def divide_by_middle(times):
    """Return times relative to that of the table's middle cell, 128³ voxels and 512² pixels."""
    return {cell: t / times[MIDDLE] for cell, t in times.items()}


def claim_ranking(ranked):
    """Claim which of the four renderers is the fastest, and which the slowest, in all settings."""
    claims = []
    for name, what, choose in (
        ("Maximum intensity", "the fastest", min),
        ("The radiative transfer equation", "the slowest", max),
    ):
        chosen = {setting: choose(times, key=times.get) for setting, times in ranked.items()}
        holds = {setting: NAMES[renderer] == name for setting, renderer in chosen.items()}
        ours, verdict = judge_over_grid(("number of steps", "maximum"), holds)
        says = f"{name} is {what} of the four renderers."
        claims.append(Claim(says, "ch. 7", "no figure", ours, verdict, WHY_RANKED))
    return claims


def claim_growth(more, small, large, ours):
    """Claim how much longer a larger volume or frame takes."""
    printed = {name: times[large] / times[small] for name, times in PRINTED.items()}
    found = {name: times[large] / times[small] for name, times in ours.items()}
    low, high = min(printed.values()) / CLOSE, max(printed.values()) * CLOSE
    return Claim(
        f"{more} take about three times as long.",
        "Table 7.1",
        ", ".join(f"{ratio:.1f} times on a {name}" for name, ratio in printed.items()),
        ", ".join(f"{ratio:.1f} times by {name}" for name, ratio in found.items()),
        judge_over_grid(("renderer",), {(n,): low < r < high for n, r in found.items()})[1],
        f"Holds within a factor of {CLOSE:g}. The thesis does not say which renderer its table is "
        "of. Their small cells are held up by the browser, and may leave parts of the graphics "
        "chip idle.",
    )


def claim_rate():
    """Claim that the printed times allow 20 iterations per second."""
    slowest = max(max(times.values()) for times in PRINTED.values())
    fit = sum(t <= 1000 / RATE for times in PRINTED.values() for t in times.values())
    cells = sum(map(len, PRINTED.values()))
    return Claim(
        f"{RATE} iterations per second and more, also on mobile.",
        "ch. 7",
        "its conclusions have 10 and more",
        f"{fit} of the {cells} printed times allow {RATE}, the slowest {1000 / slowest:.1f}",
        to_verdict(fit == cells),
        "By the thesis's own table, which fits its conclusions.",
        arithmetic=True,
    )
