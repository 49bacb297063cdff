"""Simulates a running mean in 16-bit floats, which stops changing or drifts away."""

import numpy as np

from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 2
PIXELS = 4096
SHOWN = 100, 300, 1000, 3000, 10_000
REFERENCE = 1000  # iterations of the thesis's reference pictures
CLOSE = 1.1  # times the error of 32 bits, below which a mean counts as converged
NOISES = {
    "even, 0.45 to 0.55": (0.5, lambda rng: 0.45 + 0.1 * rng.random(PIXELS, np.float32)),
    "0 or 1, mean 0.1": (0.1, lambda rng: (rng.random(PIXELS) < 0.1).astype(np.float32)),
}
TEXT = f"""The thesis keeps a picture's mean A over n iterations in 16-bit floats:
A ← A + (G - A) / n. Here the same is done for {PIXELS:,} pixels with made noise G in single
precision, and A is rounded to 16 or to 32 bits after each iteration. brdfkit accumulates in 32."""


@in_turn
def check_claims(sources, report):
    """Check the claims on running means in 16-bit floats; return their section of the page."""
    found = {}
    for done, (name, (mean, draw)) in enumerate(NOISES.items()):
        for kind in (np.float16, np.float32):
            found[name, kind] = measure_errors(mean, draw, kind)
            report(2 * done + (kind is np.float32) + 1, 2 * len(NOISES))
    names = {np.float16: "16 bits", np.float32: "32 bits"}
    rows = [
        (name, names[kind], *(f"{rms[n - 1]:.5f} ({bias[n - 1]:+.5f})" for n in SHOWN))
        for (name, kind), (rms, bias) in found.items()
    ]
    caption = "Root mean squares of the error, and its mean, after n iterations."
    table = Table(("noise", "A", *(f"{n:,}" for n in SHOWN)), rows, caption)
    picture = Picture(
        "half_floats", draw_errors(found), "Dashed lines: 16 bits; solid lines: 32 bits."
    )
    return Section("A mean in 16 bits", TEXT, [claim_stall(found)], [table], [picture])


def measure_errors(mean, draw, kind):
    """Return the RMS error of the pixels and their mean error, after each iteration.

    `draw` makes the noise of an iteration from a generator; `kind` is the type of the running mean.
    """
    rng = np.random.default_rng(0)
    a, rms, bias = np.zeros(PIXELS, kind), [], []
    for n in range(1, SHOWN[-1] + 1):
        g = draw(rng)
        a = (a + (g - a) / np.float32(n)).astype(kind)
        off = a.astype(np.float32) - np.float32(mean)
        rms.append(np.sqrt(np.mean(off * off)))
        bias.append(off.mean())
    return np.array(rms), np.array(bias)


def claim_stall(found):
    """Claim that 1000 iterations in 16 bits are a converged reference."""
    errors = {
        n: {
            name: found[name, np.float16][0][n - 1] / found[name, np.float32][0][n - 1]
            for name in NOISES
        }
        for n in (REFERENCE, SHOWN[-1])
    }
    said = "; ".join(
        f"after {n:,} " + ", ".join(f"{ratio:.1f} ({name})" for name, ratio in ratios.items())
        for n, ratios in errors.items()
    )
    holds = {(name,): ratio < CLOSE for name, ratio in errors[REFERENCE].items()}
    return Claim(
        f"After {REFERENCE:,} iterations a mean in 16-bit floats has converged.",
        "ch. 6, 7",
        "the reference of its curves",
        f"its error over that of 32 bits, by the noise: {said}",
        judge_over_grid(("noise",), holds)[1],
        f"Holds below {CLOSE:g} times. What is added becomes less than half of the last bit: small "
        "noise adds nothing any more, and after more iterations the ones alone count of 0 or 1, "
        "which doubles the mean. A sample of scattered light is more like 0 or 1.",
    )


def draw_errors(found):
    """Draw the errors over the number of iterations."""
    drawn = make_figure(6, 2.8)
    axes = drawn.subplots()
    n = np.arange(1, SHOWN[-1] + 1)
    for (name, kind), (rms, _) in found.items():
        half = kind is np.float16
        style = {"linestyle": "--"} if half else {"label": name}
        axes.loglog(n, rms, color=COLOURS[list(NOISES).index(name)], linewidth=1.4, **style)
    axes.set_xlabel("iterations")
    axes.legend(fontsize=8)
    style_axes(axes, "", "error")
    return drawn
