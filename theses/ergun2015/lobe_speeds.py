"""C11: how fast lobes make a picture, by method, as ratios."""

from brdfkit.theses.ergun2015.lit_balls import find_probes, integrators, material, render

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scene_input.loading import find_scene
from brdfkit.theses.claims import Claim, verdict
from brdfkit.theses.page import Section, Table

SECONDS = 20
SIZE, ALPHA, TIMES = 256, 0.1, 20
PRINTED = {"warped": 5200, "kde": 1600, "gmm": 990, "filtered_sampling": 490}
SLOWEST = "filtered_sampling"
CLEAR = 1.3  # times as fast, below which two count as equal
TEXT = f"""Seconds of CPU for a ball of {SIZE} × {SIZE} pixels, α = {ALPHA:g}, the least of {TIMES};
lobes are fitted and light is filtered before. The thesis's frames per second are of a graphics card
that it does not name, so only ratios are compared."""


@in_turn
def run(sources, report):
    """The times, and the claims on them."""
    import mitsuba as mi

    use_variant()
    light = mi.load_dict(
        describe_environment(next(iter(find_probes(sources).values()))), parallel=False
    )
    made = find_scene("ball")(material(ALPHA), (SIZE, SIZE))
    methods, seconds = integrators(), {}
    for done, (kind, integrator) in enumerate(methods.items()):
        render(made, light, integrator)  # fits, filters and compiles
        seconds[kind] = min(render(made, light, integrator)[1] for _ in range(TIMES))
        report(done + 1, len(methods))
    mips = {method: taken for (method, filter_), taken in seconds.items() if filter_ == "mips"}
    speed = {method: mips[SLOWEST] / mips[method] for method in PRINTED}
    rows = [
        (f"{method}, {filter_}", f"{1e3 * taken:.1f}", f"{mips[SLOWEST] / taken:.1f}")
        for (method, filter_), taken in seconds.items()
    ]
    table = Table(("method", "CPU time [ms]", "speed"), rows, f"Speeds: {SLOWEST} with mips is 1.")
    return Section("Speed of lobes", TEXT, [order_claim(speed), kernels_claim(speed)], [table])


def order_claim(speed):
    """C11: the fastest and the slowest; `speed`: method → speed, that of the slowest is 1."""
    fastest, *between, slowest = speed.values()
    return Claim(
        "One warped lobe is the fastest, and filtered sampling the slowest of four.",
        "9.3",
        ratios({method: rate / PRINTED[SLOWEST] for method, rate in PRINTED.items()}),
        ratios(speed),
        verdict(fastest > max(between) and min(between) > slowest),
    )


def kernels_claim(speed):
    """C11: the two methods between."""
    return Claim(
        "Kernels are faster than mixtures.",
        "9.3",
        f"{PRINTED['kde'] / PRINTED['gmm']:.1f} times",
        f"{speed['kde'] / speed['gmm']:.1f} times",
        verdict(speed["kde"] > CLEAR * speed["gmm"]),
        f"Confirmed above {CLEAR:g}: times differ by a tenth from run to run. Both have 32 lobes "
        "here, which are looked up alike. The thesis does not say how many kernels it took, and "
        "elsewhere calls mixtures the cheaper ones.",
    )


def ratios(speed):
    """Speeds by method, as a text."""
    return ", ".join(f"{method} {value:.1f}" for method, value in speed.items())
