"""Compares how fast methods with Gaussian lobes make a picture, as ratios of interleaved times."""

from itertools import product

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import (
    METHODS,
    find_probes,
    make_integrators,
    make_ward_bsdf,
    render_filtered,
)
from brdfkit.theses.ergun2015.printed_forms import (
    DIRECTIONS,
    KERNELS,
    make_printed_integrators,
    name_kernels,
    name_mixture,
    name_sampling,
    name_warped,
)

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scene_input.loading import find_scene
from brdfkit.theses.claims import Claim
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table
from brdfkit.theses.timing import compare_times, measure_in_turns

SECONDS = 40
SIZE, ALPHA, TURNS = 256, 0.1, 21
PRINTED = {"warped": 5200, "kde": 1600, "gmm": 990, "filtered_sampling": 490}
GMM, SLOWEST = name_mixture(0.5), "filtered_sampling"
TEXT = f"""Seconds of CPU in one thread for a ball of {SIZE} × {SIZE} pixels, α = {ALPHA:g}, with
mips; lobes are fitted and light is filtered before. {TURNS} pictures of each method, in turns; one
is faster than another where the 95 % interval of their ratio says so. The thesis's frames per
second are of a graphics card that it does not name, so only ratios are compared. It tells neither
the number of kernels nor that of directions; mixtures have its 32 lobes."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the speeds of methods with Gaussian lobes, and return their section."""
    seconds = measure_pictures(sources)
    report(1, 1)
    base = seconds[name_sampling(64, 1)]
    rows = [
        (label, f"{1e3 * np.median(taken):.1f}", str(compare_times(base, taken)))
        for label, taken in seconds.items()
    ]
    heads = "method", "median CPU time [ms]", f"speed over {name_sampling(64, 1)}"
    claims = [claim_order(seconds), claim_kernels(seconds)]
    return Section("Speed of lobes", TEXT, claims, [Table(heads, rows)])


def measure_pictures(sources):
    """Return the CPU seconds (TURNS,) of the ball's picture by each method with mips."""
    import mitsuba as mi

    use_variant()
    light = mi.load_dict(
        describe_environment(next(iter(find_probes(sources).values()))), parallel=False
    )
    made = find_scene("ball")(make_ward_bsdf(ALPHA), (SIZE, SIZE))
    ours = {name: by for (name, filter_), by in make_integrators().items() if filter_ == "mips"}
    lights = dict.fromkeys(("mips", "lobes"), ours[METHODS[0]].light)
    printed = make_printed_integrators(lights)
    names = name_warped(0.5, "mips"), *(name_kernels(n, 0.5) for n in KERNELS), GMM
    names += tuple(name_sampling(d, 1) for d in DIRECTIONS)
    methods = ours | {name: printed[name] for name in names}
    # The first pictures fit and filter, which is not timed
    scenes = {label: render_filtered(made, light, by)[2] for label, by in methods.items()}
    return measure_in_turns(
        {
            label: lambda by=by, label=label: np.array(by.render(scenes[label], seed=0, spp=1))
            for label, by in methods.items()
        },
        TURNS,
    )


def claim_order(seconds):
    """Claim which method is the fastest and which the slowest, by numbers of lobes and directions.

    `seconds` maps labels to times (TURNS,).
    """
    lobe, cells = seconds[name_warped(0.5, "mips")], {}
    for n, d in product(KERNELS, DIRECTIONS):
        between = seconds[name_kernels(n, 0.5)], seconds[GMM]
        slowest = seconds[name_sampling(d, 1)]
        cells[str(n), str(d)] = all(
            compare_times(each, lobe).low > 1 and compare_times(slowest, each).low > 1
            for each in between
        )
    ours, verdict = judge_over_grid(("number of kernels", "number of directions"), cells)
    speeds = ", ".join(f"{name} {rate / PRINTED[SLOWEST]:.1f}" for name, rate in PRINTED.items())
    return Claim(
        "One warped lobe is the fastest, and filtered sampling the slowest: the thesis's forms.",
        "9.3",
        speeds,
        f"{ours}; with 64 directions and 32 kernels {describe_speeds(seconds)}",
        verdict,
    )


def describe_speeds(seconds):
    """Return the speeds of the thesis's forms over that of 64 directions, in words."""
    base = seconds[name_sampling(64, 1)]
    each = {"warped": name_warped(0.5, "mips"), "kde": name_kernels(32, 0.5), "gmm": GMM}
    words = (f"{name} {compare_times(base, seconds[by]).value:.1f}" for name, by in each.items())
    return f"{', '.join(words)}, filtered_sampling 1.0"


def claim_kernels(seconds):
    """Claim that kernels are faster than mixtures, by the number of kernels."""
    ratios = {n: compare_times(seconds[GMM], seconds[name_kernels(n, 0.5)]) for n in KERNELS}
    ours, verdict = judge_over_grid(
        ("number of kernels",), {(str(n),): ratio.low > 1 for n, ratio in ratios.items()}
    )
    return Claim(
        "Kernels are faster than mixtures: the thesis's forms.",
        "9.3",
        f"{PRINTED['kde'] / PRINTED['gmm']:.1f} times",
        f"{ours}; " + ", ".join(f"{ratio} times with {n} kernels" for n, ratio in ratios.items()),
        verdict,
        "Mixtures have 32 lobes, which are read from the nearest view, and "
        "kernels are computed. The thesis does not say how many kernels it took, and elsewhere "
        "calls mixtures the cheaper ones.",
    )
