"""Compares Schlick's phase function with Henyey-Greenstein's: its sign, range and distance."""

import numpy as np
from brdfkit.theses.lesar2018.phases import compute_moments, henyey_greenstein, schlick

from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.drawing import make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 1
GS = 0.1, 0.3, 0.6, 0.8, 0.9
POINTS = 2001  # values of μ, for pictures
CELLS = 200_000  # of the quadrature over μ
TEXT = """p(μ) = (1 - k²) / (4π (1 - kμ)²) with k = 1.55 g - 0.55 g³, beside Henyey-Greenstein's of
the same g. *Distance*: of the two as probabilities, the largest difference of any event."""

CAPTION = "Left: Henyey-Greenstein's, thick, and Schlick's. Right: k(g), which should be below 1."


@in_turn
def check_claims(sources, report):
    """Check the claims on Schlick's phase function; return their section of the page."""
    rows = [
        (f"{g:g}", *(f"{v:.5f}" for v in compare_schlick(g)[:3]), *format_extremes(g)) for g in GS
    ]
    heads = "g", "k", "mean cosine", "distance", "least", "largest"
    caption = "Least and largest: the difference from Henyey-Greenstein's, relative to it."
    claims = [claim_sign(), claim_range(), claim_likeness()]
    picture = Picture("schlick", draw_schlick(), CAPTION)
    return Section("Schlick's phase function", TEXT, claims, [Table(heads, rows, caption)],
                   [picture])  # fmt: skip


def compute_k(g):
    """Return the parameter k of Schlick's phase function for a mean cosine g, by eq. 4.60."""
    return 1.55 * g - 0.55 * g**3


def compare_schlick(g):
    """Return Schlick's k for g, its mean cosine, and its distance from Henyey-Greenstein's."""
    k = compute_k(g)
    mu = (np.arange(CELLS) + 0.5) / CELLS * 2 - 1
    apart = np.abs(schlick(k, mu) - henyey_greenstein(g, mu))
    return k, compute_moments(lambda mu: schlick(k, mu))[1], 2 * np.pi * apart.mean()


def format_extremes(g):
    """Return, as text, the extreme relative differences of Schlick's from Henyey-Greenstein's."""
    mu = np.linspace(-1, 1, POINTS)
    relative = schlick(compute_k(g), mu) / henyey_greenstein(g, mu) - 1
    return f"{100 * relative.min():+.1f} %", f"{100 * relative.max():+.1f} %"


def claim_sign():
    """Claim that Schlick's formula with the printed sign resembles Henyey-Greenstein's."""
    g = 0.6
    printed = compute_moments(lambda mu: schlick(compute_k(g), -mu))[1]
    return Claim(
        "Schlick's formula, 1 + k cos θ below, resembles Henyey-Greenstein's of the same g.",
        "eq. 4.59",
        "1 + k ω·ω' beside 1 + g² - 2g ω·ω'",
        f"mean cosine {printed:+.3f} for g = {g:g}",
        to_verdict(printed > 0),
        "The two formulas use directions of opposite senses. With 1 - k cos θ the mean cosine is "
        f"{-printed:+.3f}; so it stands in `schlick`.",
    )


def claim_range():
    """Claim that Schlick's parameter k is valid for each mean cosine g."""
    g = np.linspace(0, 1, 1_000_001)[:-1]
    last = g[compute_k(g) < 1].max()
    return Claim(
        "k = 1.55 g - 0.55 g³ is a parameter for each g between -1 and 1.",
        "eq. 4.60",
        "|g| < 1",
        f"|k| < 1 up to |g| = {last:.5f}",
        to_verdict(last > 0.999),
        "Beyond, the density is negative and has no integral. `schlick` takes |k| to 0.999.",
    )


def claim_likeness():
    """State the distance from Henyey-Greenstein's, which the thesis does not give."""
    found = {g: compare_schlick(g) for g in (0.3, 0.9)}
    said = "; ".join(
        f"g = {g:g}: mean cosine {mean:.3f}, distance {distance:.3f}"
        for g, (_, mean, distance) in found.items()
    )
    return Claim(
        "Schlick's with k(g) is near Henyey-Greenstein's of g.",
        "eq. 4.60",
        "no figure",
        said,
        UNSTATED,
        "k(g) keeps neither the mean cosine nor the peak.",
    )


def draw_schlick():
    """Draw Schlick's and Henyey-Greenstein's phase functions for some g, and k over g."""
    drawn = make_figure(8, 2.8)
    left, right = drawn.subplots(1, 2)
    mu = np.linspace(-1, 1, POINTS)
    for g, colour in zip((0.3, 0.6, 0.9), ("#0072b2", "#e69f00", "#009e73"), strict=True):
        left.semilogy(mu, henyey_greenstein(g, mu), color=colour, linewidth=2.2, label=f"g = {g}")
        left.semilogy(mu, schlick(compute_k(g), mu), color="#222222", linewidth=1)
    left.set_xlabel("μ")
    left.legend(fontsize=8)
    style_axes(left, "", "p [sr⁻¹]")
    g = np.linspace(0.85, 1, POINTS)
    right.plot(g, compute_k(g), color="#0072b2")
    right.axhspan(1, 1.005, color="#d55e00", alpha=0.25, linewidth=0)
    right.set_ylim(0.975, 1.005)
    right.set_xlabel("g")
    style_axes(right, "", "k")
    return drawn
