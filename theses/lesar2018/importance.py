"""Compares directions drawn by a phase function with even ones, for light from all around."""

import numpy as np
from brdfkit.theses.lesar2018.phases import PLUGINS

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table

SECONDS = 3
DRAWS, TURNS = 256, 4096  # directions for each of so many incident ones
LIGHTS = {  # concentration of a lamp about +y, and its share of the light; the rest is a soft sky
    "a soft sky": (0.0, 0.0),
    "a wide lamp": (4.0, 0.5),
    "a sun": (400.0, 0.5),
}
TEXT = f"""The light that a phase function scatters is the mean of its value times the light over
directions that are drawn evenly, or of the light over directions that it draws itself. The variance
of the first is set over that of the second, which takes as many times fewer iterations; means over
{TURNS} random directions of view. The light is a sky, brighter above, and a lamp of half its
power."""


@in_turn
def check_claims(sources, report):
    """Check the claim on importance sampling; return its section of the page."""
    use_variant()
    gains = {}
    for done, (name, entries) in enumerate(PLUGINS.items()):
        for light, lamp in LIGHTS.items():
            gains[name, light] = measure_gain(entries, lamp)
        report(done + 1, len(PLUGINS))
    ours, verdict = judge_over_grid(
        ("phase function", "light"), {c: g > 1 for c, g in gains.items()}
    )
    claim = Claim(
        "Importance sampling speeds it up.",
        "ch. 5, 8",
        "no figure",
        f"{ours}, {min(gains.values()):.2g} to {max(gains.values()):.3g} times fewer iterations",
        verdict,
        "Counted in iterations: a direction that is drawn costs a picture at most a tenth more, as "
        "measured above. Least under a lamp that is smaller than the phase function's lobe, where "
        "directions drawn by the lamp help more; brdfkit draws both.",
    )
    rows = [(name, *(f"{gains[name, light]:.2f}" for light in LIGHTS)) for name in PLUGINS]
    table = Table(
        ("phase function", *LIGHTS), rows, "The variance by even directions over its own."
    )
    return Section("Importance sampling", TEXT, [claim], [table])


def measure_gain(entries, lamp):
    """Return the variance by even directions over that by a phase function's own, in one light."""
    import mitsuba as mi

    phase, rng = mi.load_dict(entries, parallel=False), np.random.default_rng(0)
    context, count = mi.PhaseFunctionContext(None), DRAWS * TURNS
    it = mi.MediumInteraction3f()
    it.wi = mi.Vector3f(np.repeat(draw_directions(rng, TURNS), DRAWS, axis=0).T)
    it.sh_frame = mi.Frame3f(-it.wi)
    u = rng.random((3, count)).astype(np.float32)
    wo, weight, _ = phase.sample(context, it, mi.Float(u[0]), mi.Point2f(u[1], u[2]))
    own = np.array(weight)[0] * evaluate_light(np.array(wo).T, lamp)
    even = draw_directions(rng, count)
    value = np.array(phase.eval_pdf(context, it, mi.Vector3f(even.T))[0])[0]
    plain = 4 * np.pi * value * evaluate_light(even, lamp)
    variances = (v.reshape(TURNS, DRAWS).var(axis=1, ddof=1).mean() for v in (plain, own))
    return float(np.divide(*variances))


def draw_directions(rng, count):
    """Return even random directions (count, 3)."""
    d = rng.normal(size=(count, 3))
    return (d / np.linalg.norm(d, axis=1, keepdims=True)).astype(np.float32)


def evaluate_light(w, lamp):
    """Return the light from directions w (n, 3): a sky, and a lamp of a concentration and share."""
    kappa, share = lamp
    sky = 0.5 + 0.5 * w[:, 1]
    if not kappa:
        return sky
    lobe = 2 * kappa / (1 - np.exp(-2 * kappa)) * np.exp(kappa * (w[:, 1] - 1))
    return (1 - share) * sky + share * 0.5 * lobe  # both with a mean of 1/2 over the sphere
