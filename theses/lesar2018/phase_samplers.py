"""Checks directions drawn by phase functions (chapter 5): their distributions and times."""

import numpy as np
from brdfkit.theses.lesar2018.phases import PLUGINS, TARGETS, fit_two_lobes
from brdfkit.theses.lesar2018.sampler_times import (
    DRAWS,
    REPEATS,
    list_plugins,
    list_samplers,
    prepare_draws,
    prepare_picture,
    sample_rayleigh,
)

from brdfkit.checks import directions
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table
from brdfkit.theses.timing import compare_times, measure_in_turns

SECONDS = 10
TURNS = 7
FIRST, LOBES = "Henyey-Greenstein", "two of Schlick's"
TEXT = f"""Each random ξ gives the μ below which its share of the light is scattered. The time of a
draw is that of {REPEATS} times {DRAWS:,} in one kernel; the time of a picture that of a cube of
even smoke, whose collisions cost least, by `single_scattering`. Both are told over
Henyey-Greenstein's. They take turns, {TURNS} each, in one thread, and a verdict needs the whole
95 % interval of a ratio. Fits of two of Schlick's lobes, p ≈ r S(k₁) + (1 - r) S(k₂), are by least
squares over μ; the thesis proposes such, and prints none."""


@in_turn
def check_claims(sources, report):
    """Check the claims on directions drawn by phase functions; return their section of the page."""
    use_variant()
    rejected = [name for name, entries in PLUGINS.items() if compute_p_value(entries) is None]
    report(1, 3)
    fits = {name: fit_two_lobes(*target) for name, target in TARGETS.items()}
    samplers, plugins = list_samplers().items(), list_plugins(fits).items()
    draws = measure_in_turns({name: prepare_draws(draw) for name, draw in samplers}, TURNS)
    report(2, 3)
    seconds = measure_in_turns({name: prepare_picture(p) for name, p in plugins}, TURNS)
    claims = [
        claim_inverse(rejected),
        claim_rayleigh(draws, seconds),
        claim_faster(draws, seconds),
        *(claim_mie(name, fits[name], draws, seconds) for name in ("Mie hazy", "Mie murky")),
    ]
    times = [
        (name, *(f"{compare_times(t[name], t[FIRST]).value:.2f}" for t in (draws, seconds)))
        for name in seconds
    ]
    times = Table(
        ("phase function", "a draw", "a picture"), times, "Times over Henyey-Greenstein's."
    )
    rows = [(n, *(f"{v:.4f}" for v in x), f"{e:.3f}", f"{100 * m:.0f} %")
            for n, (x, e, m) in fits.items()]  # fmt: skip
    heads = "", "r", "k₁", "k₂", "error", "largest"
    caption = "Two of Schlick's lobes: errors of p relative to its norm, and the largest relative."
    return Section("Directions drawn", TEXT, claims, [times, Table(heads, rows, caption)])


def compute_p_value(entries):
    """Return the p-value of a χ² test that a plugin draws by its density, None if rejected."""
    import mitsuba as mi

    phase, it = mi.load_dict(entries, parallel=False), mi.MediumInteraction3f()
    it.p, it.wi = mi.Point3f(0), mi.Vector3f(0, 0, -1)
    it.sh_frame = mi.Frame3f(it.wi)
    context = mi.PhaseFunctionContext(None)
    return directions.run_chi_squared_test(
        lambda u, v, w: phase.sample(context, it, u, mi.Point2f(v, w)),
        lambda wo: phase.eval_pdf(context, it, wo)[1],
        len(PLUGINS),
        dimensions=3,
    )


def claim_inverse(rejected):
    """Claim that all samplers draw by their densities."""
    said = f"χ² tests reject {len(rejected)} of {len(PLUGINS)}"
    return Claim(
        "Inverses of the distributions draw by the phase functions.",
        "eq. 5.58-5.67",
        "formulas",
        f"{said}: {', '.join(rejected)}" if rejected else said,
        to_verdict(not rejected),
        f"{directions.SAMPLES:,} draws of each plugin, significance {directions.SIGNIFICANCE:g} of "
        "all together. Schlick's with the sign of Henyey-Greenstein's.",
    )


def claim_rayleigh(draws, seconds):
    """Claim that Rayleigh's inverse is too slow to draw from."""
    u = np.linspace(0.001, 0.999, 999)
    with np.errstate(invalid="ignore"):
        by_power = np.isnan(sample_rayleigh(u, lambda x: x ** (1 / 3))).sum()
    mu = sample_rayleigh(u, np.cbrt)
    off = np.abs(0.5 + mu * (3 + mu * mu) / 8 - u).max()
    draw, ratio = (compare_times(times["Rayleigh"], times[FIRST]) for times in (draws, seconds))
    return Claim(
        "Rayleigh's inverse is too slow to be drawn from while one waits.",
        "eq. 5.67",
        "no figure",
        f"a draw takes {draw.value:.1f} times as long as by Henyey-Greenstein's, and a picture "
        f"{ratio}; the inverse is off by {off:.0e}",
        to_verdict(ratio.low > 1.5),
        f"With real cube roots: a power of 1/3 is no number for {by_power} of {len(u)} ξ. Judged "
        "by the picture, since one waits for that: confirmed where it takes 1.5 times as long.",
    )


def claim_faster(draws, seconds):
    """Claim that Schlick's phase function is faster to draw from than Henyey-Greenstein's."""
    draw, ratio = (compare_times(times[FIRST], times["Schlick"]) for times in (draws, seconds))
    return Claim(
        "Schlick's is noticeably faster to draw from than Henyey-Greenstein's.",
        "eq. 5.63",
        "no figure",
        f"a draw is {draw} times as fast, and a picture {ratio}",
        to_verdict(draw.low > 1.1),
        "Eq. 5.59, the other inverse, has no power either. Judged by the draw: confirmed where it "
        "is 1.1 times as fast.",
    )


def claim_mie(name, found, draws, seconds):
    """Claim that two lobes are faster than a Mie approximation, which can be drawn exactly."""
    _, error, largest = found
    draw, ratio = (compare_times(times[name], times[LOBES]) for times in (draws, seconds))
    return Claim(
        f"{name} is too costly to draw from; two of Schlick's lobes should stand for it.",
        "eq. 4.62, 4.63",
        "no fit, no figure",
        f"a draw takes {draw.value:.1f} times as long as by two lobes, and a picture {ratio}; the "
        f"lobes are off by {error:.3f}, {100 * largest:.0f} % at most",
        to_verdict(ratio.low > 1.5),
        "It is drawn without inverting the whole: it is an equal mixture of even light and of a "
        "power, whose inverse is a root, μ = 2 ξ^(1/(n+1)) - 1. Judged by the picture: confirmed "
        "where it takes 1.5 times as long.",
    )
