"""Simulates a running mean in 16-bit floats, which stops changing or drifts away."""

import numpy as np

from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 2
PIXELS = 4096
SHOWN = 100, 300, 1000, 3000, 10_000
REFERENCE = 1000  # iterations of the thesis's reference pictures
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
    picture = Picture("half_floats", draw_errors(found), "Dashed: 16 bits.")
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
    (half, _), (full, _) = (found["even, 0.45 to 0.55", k] for k in (np.float16, np.float32))
    _, drift = found["0 or 1, mean 0.1", np.float16]
    last = SHOWN[-1]
    return Claim(
        f"After {REFERENCE:,} iterations a mean in 16-bit floats has converged.",
        "ch. 6, 7",
        "the reference of its curves",
        f"its error is {half[REFERENCE - 1] / full[REFERENCE - 1]:.1f} times that of 32 bits, and "
        f"{half[last - 1] / full[last - 1]:.1f} times after {last:,}; of 0 or 1 the mean is "
        f"{drift[last - 1]:+.3f} off then",
        to_verdict(half[REFERENCE - 1] < 1.1 * full[REFERENCE - 1]),
        "What is added becomes less than half of the last bit: small noise adds nothing any more, "
        "and of 0 or 1 the ones alone count, which doubles the mean. Confirmed below 1.1 times.",
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
