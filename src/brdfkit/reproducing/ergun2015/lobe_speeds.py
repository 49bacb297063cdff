"""C11: how fast lobes make a picture, by method, as ratios."""

from itertools import pairwise

from brdfkit.jit.llvm import use_variant
from brdfkit.jit.threads import in_turn
from brdfkit.rendering.environment import environment
from brdfkit.rendering.scene_loading import find_scene
from brdfkit.reproducing.claims import Claim, verdict
from brdfkit.reproducing.ergun2015.lit_balls import integrators, material, render
from brdfkit.reproducing.ergun2015.probes import find_probes
from brdfkit.reproducing.page import Section, Table

SECONDS = 20
SIZE, ALPHA, TIMES = 256, 0.1, 5
PRINTED = {"warped": 5200, "kde": 1600, "gmm": 990, "filtered_sampling": 490}
SLOWEST = "filtered_sampling"
CLEAR = 1.1  # times as fast, below which two count as equal
TEXT = f"""Seconds of CPU for a ball of {SIZE} × {SIZE} pixels, α = {ALPHA:g}, the least of {TIMES};
lobes are fitted and light is filtered before. The thesis's frames per second are of a graphics card
that it does not name, so only ratios are compared."""


@in_turn
def run(sources, report):
    """The times, and the claim on their order."""
    import mitsuba as mi

    use_variant()
    light = mi.load_dict(environment(next(iter(find_probes(sources).values()))), parallel=False)
    made = find_scene("ball")(material(ALPHA), (SIZE, SIZE))
    methods, seconds = integrators(), {}
    for done, (kind, integrator) in enumerate(methods.items()):
        render(made, light, integrator)  # fits, filters and compiles
        seconds[kind] = min(render(made, light, integrator)[1] for _ in range(TIMES))
        report(done + 1, len(methods))
    mips = {method: taken for (method, filter_), taken in seconds.items() if filter_ == "mips"}
    speed = {method: mips[SLOWEST] / mips[method] for method in PRINTED}
    rates = list(speed.values())
    in_order = all(a > CLEAR * b for a, b in pairwise(rates))
    claim = Claim(
        "One warped lobe is the fastest, then kernels, mixtures, and filtered sampling.",
        "9.3",
        " : ".join(f"{rate / PRINTED[SLOWEST]:.1f}" for rate in PRINTED.values()),
        " : ".join(f"{value:.1f}" for value in speed.values()) + ", in this order of methods",
        verdict(in_order),
        f"Confirmed where each is {CLEAR:g} times as fast as the next. Kernels and mixtures have "
        "32 lobes here, and cost the same; the thesis does not say how many kernels it took, and "
        "elsewhere calls mixtures the cheaper ones. Its kernels are computed from the view, ours "
        "are looked up, as the mixtures are.",
    )
    rows = [
        (f"{method}, {filter_}", f"{1e3 * taken:.1f}", f"{mips[SLOWEST] / taken:.1f}")
        for (method, filter_), taken in seconds.items()
    ]
    table = Table(("method", "CPU time [ms]", "speed"), rows, f"Speeds: {SLOWEST} with mips is 1.")
    return Section("Speed of lobes", TEXT, [claim], [table])
