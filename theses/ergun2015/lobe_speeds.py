"""Compares how fast methods with Gaussian lobes make a picture, as ratios."""

from brdfkit.theses.ergun2015.lit_balls import (
    find_probes,
    make_integrators,
    make_ward_bsdf,
    render_filtered,
    render_scene,
)

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scene_input.loading import find_scene
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 20
SIZE, ALPHA, TIMES = 256, 0.1, 20
PRINTED = {"warped": 5200, "kde": 1600, "gmm": 990, "filtered_sampling": 490}
SLOWEST = "filtered_sampling"
CLEAR = 1.3  # the ratio of speeds from which one counts as faster
TEXT = f"""Seconds of CPU for a ball of {SIZE} × {SIZE} pixels, α = {ALPHA:g}, the least of {TIMES};
lobes are fitted and light is filtered before. The thesis's frames per second are of a graphics card
that it does not name, so only ratios are compared."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the speeds of methods with Gaussian lobes, and return their section."""
    import mitsuba as mi

    use_variant()
    light = mi.load_dict(
        describe_environment(next(iter(find_probes(sources).values()))), parallel=False
    )
    made = find_scene("ball")(make_ward_bsdf(ALPHA), (SIZE, SIZE))
    methods, seconds = make_integrators(), {}
    for done, (kind, integrator) in enumerate(methods.items()):
        render_filtered(made, light, integrator)  # fits, filters and compiles, which is not timed
        seconds[kind] = min(render_scene(made, light, integrator)[1] for _ in range(TIMES))
        report(done + 1, len(methods))
    mips = {method: taken for (method, filter_), taken in seconds.items() if filter_ == "mips"}
    speed = {method: mips[SLOWEST] / mips[method] for method in PRINTED}
    rows = [
        (f"{method}, {filter_}", f"{1e3 * taken:.1f}", f"{mips[SLOWEST] / taken:.1f}")
        for (method, filter_), taken in seconds.items()
    ]
    table = Table(("method", "CPU time [ms]", "speed"), rows, f"Speeds: {SLOWEST} with mips is 1.")
    return Section("Speed of lobes", TEXT, [claim_order(speed), claim_kernels(speed)], [table])


def claim_order(speed):
    """Claim which method with lobes is the fastest and which the slowest, whose speed is 1."""
    fastest, *between, slowest = speed.values()
    return Claim(
        "One warped lobe is the fastest, and filtered sampling the slowest of four.",
        "9.3",
        format_speeds({method: rate / PRINTED[SLOWEST] for method, rate in PRINTED.items()}),
        format_speeds(speed),
        to_verdict(fastest > max(between) and min(between) > slowest),
    )


def claim_kernels(speed):
    """Claim that kernels are faster than mixtures."""
    return Claim(
        "Kernels are faster than mixtures.",
        "9.3",
        f"{PRINTED['kde'] / PRINTED['gmm']:.1f} times",
        f"{speed['kde'] / speed['gmm']:.1f} times",
        to_verdict(speed["kde"] > CLEAR * speed["gmm"]),
        f"Confirmed above {CLEAR:g}: times differ by a tenth from run to run. Both have 32 lobes "
        "here, which are looked up alike. The thesis does not say how many kernels it took, and "
        "elsewhere calls mixtures the cheaper ones.",
    )


def format_speeds(speed):
    """Return speeds by method as a text."""
    return ", ".join(f"{method} {value:.1f}" for method, value in speed.items())
