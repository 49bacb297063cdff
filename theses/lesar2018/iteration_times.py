"""Reproduces Table 7.1, the time of an iteration by renderer, volume size and frame size."""

from brdfkit.theses.lesar2018.iterations import make_cloud, make_renderer, make_stage
from brdfkit.theses.lesar2018.renderers import RENDERERS

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, measure_least_seconds, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 60
VOXELS, FRAMES = (64, 128, 256), (256, 512, 1024)
MIDDLE = 128, 512  # voxels and pixels of the cell to which other times are compared
TIMES = 3
PRINTED = {  # ms, by (voxels, frame)
    "phone": {(64, 512): 28, (128, 512): 65, (256, 512): 92, (128, 256): 35, (128, 1024): 98},
    "laptop": {(64, 512): 16, (128, 512): 28, (256, 512): 45, (128, 256): 16, (128, 1024): 55},
}
CLOSE = 1.5  # two ratios count as equal within this factor
RATE = 20  # iterations per second that the thesis claims
TEXT = f"""Smoke by each renderer, one ray per pixel in an iteration, the least of {TIMES}. The
thesis does not say which renderer its table is of, nor the steps of any; here the march takes 128
steps, the others 256. Ours are seconds of CPU, of all cores together, over those of the middle
cell, as the printed ones; 16 ms is the least that a browser shows."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the time of an iteration; return their section of the page."""
    use_variant()
    cells = list(PRINTED["phone"])
    seconds, total = {}, len(cells) * len(RENDERERS)
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
    claims = [
        claim_ranking({name: seconds[name, MIDDLE] for name in RENDERERS}),
        claim_growth("64 times the voxels", (64, 512), (256, 512), ours),
        claim_growth("16 times the pixels", (128, 256), (128, 1024), ours),
        claim_rate(),
    ]
    return Section("Times of an iteration", TEXT, claims, [Table(heads, rows, caption)])


def measure_iteration(renderer, voxels, frame):
    """Return the CPU seconds of an iteration, by a renderer and sizes of volume and frame."""
    scene = make_stage(make_cloud(renderer, voxels), frame)
    seeds, render = iter(range(1, 100)), make_renderer()

    def once():
        render(scene, next(seeds)).numpy()

    once()  # compiles the kernels, which is not timed
    once()  # records the rendering, which later calls replay
    return measure_least_seconds(once, times=TIMES)


def divide_by_middle(times):
    """Return times relative to that of the table's middle cell, 128³ voxels and 512² pixels."""
    return {cell: t / times[MIDDLE] for cell, t in times.items()}


def claim_ranking(seconds):
    """Claim which of the four renderers are the fastest and the slowest."""
    order = sorted(seconds, key=seconds.get)
    said = ", ".join(f"{name} {seconds[name] / seconds[order[0]]:.1f}" for name in order)
    return Claim(
        "Maximum intensity is the fastest, the radiative transfer equation the slowest.",
        "ch. 7",
        "no figure",
        f"over the fastest: {said}",
        to_verdict(order[0] == "maximum_intensity" and order[-1] == "single_scattering"),
        "Theirs may look fewer points up in an iteration. Ours finds the whole maximum, surface or "
        "sum in one, where scattering is one collision of a ray, and empty cells cost no look-up.",
    )


def claim_growth(more, small, large, ours):
    """Claim how much longer a larger volume or frame takes."""
    printed = {name: times[large] / times[small] for name, times in PRINTED.items()}
    found = {name: times[large] / times[small] for name, times in ours.items()}
    own, others = found["single_scattering"], found.values()
    return Claim(
        f"{more} take about three times as long.",
        "Table 7.1",
        ", ".join(f"{ratio:.1f} times on a {name}" for name, ratio in printed.items()),
        f"{own:.1f} times by single_scattering, {min(others):.1f} to {max(others):.1f} by any",
        to_verdict(min(printed.values()) / CLOSE < own < max(printed.values()) * CLOSE),
        f"Confirmed within a factor of {CLOSE:g}. Their small cells are held up by the browser, "
        "and may leave parts of the graphics chip idle.",
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
    )
