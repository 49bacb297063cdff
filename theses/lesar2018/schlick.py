"""Eq. 4.59 and 4.60: Schlick's phase function, its sign, and how near it is to the other."""

import numpy as np
from brdfkit.theses.lesar2018.phases import henyey_greenstein, moments, schlick

from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import UNSTATED, Claim, verdict
from brdfkit.theses.drawing import figure, tidy
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 1
GS = 0.1, 0.3, 0.6, 0.8, 0.9
POINTS = 2001  # of μ, for pictures
CELLS = 200_000  # of a quadrature
TEXT = """p(μ) = (1 - k²) / (4π (1 - kμ)²) with k = 1.55 g - 0.55 g³, beside Henyey-Greenstein's of
the same g. *Distance*: of the two as probabilities, the largest difference of any event."""

CAPTION = "Left: Henyey-Greenstein's, thick, and Schlick's. Right: k(g), which should be below 1."


@in_turn
def run(sources, report):
    """The figures by g, and the claims on them."""
    rows = [(f"{g:g}", *(f"{v:.5f}" for v in figures(g)[:3]), *extremes(g)) for g in GS]
    heads = "g", "k", "mean cosine", "distance", "least", "largest"
    caption = "Least and largest: the difference from Henyey-Greenstein's, relative to it."
    claims = [sign_claim(), range_claim(), likeness_claim()]
    picture = Picture("schlick", draw(), CAPTION)
    return Section("Schlick's phase function", TEXT, claims, [Table(heads, rows, caption)],
                   [picture])  # fmt: skip


def k_of(g):
    """k by eq. 4.60."""
    return 1.55 * g - 0.55 * g**3


def figures(g):
    """k, the mean cosine, and the distance from Henyey-Greenstein's."""
    k = k_of(g)
    mu = (np.arange(CELLS) + 0.5) / CELLS * 2 - 1
    apart = np.abs(schlick(k, mu) - henyey_greenstein(g, mu))
    return k, moments(lambda mu: schlick(k, mu))[1], 2 * np.pi * apart.mean()


def extremes(g):
    """The least and the largest relative difference, in words."""
    mu = np.linspace(-1, 1, POINTS)
    relative = schlick(k_of(g), mu) / henyey_greenstein(g, mu) - 1
    return f"{100 * relative.min():+.1f} %", f"{100 * relative.max():+.1f} %"


def sign_claim():
    """The printed sign, in the convention of the thesis's Henyey-Greenstein."""
    g = 0.6
    printed = moments(lambda mu: schlick(k_of(g), -mu))[1]
    return Claim(
        "Schlick's formula, 1 + k cos θ below, resembles Henyey-Greenstein's of the same g.",
        "eq. 4.59",
        "1 + k ω·ω' beside 1 + g² - 2g ω·ω'",
        f"mean cosine {printed:+.3f} for g = {g:g}",
        verdict(printed > 0),
        "The two formulas use directions of opposite senses. With 1 - k cos θ the mean cosine is "
        f"{-printed:+.3f}; so it stands in `schlick`.",
    )


def range_claim():
    """Where k is a parameter at all."""
    g = np.linspace(0, 1, 1_000_001)[:-1]
    last = g[k_of(g) < 1].max()
    return Claim(
        "k = 1.55 g - 0.55 g³ is a parameter for each g between -1 and 1.",
        "eq. 4.60",
        "|g| < 1",
        f"|k| < 1 up to |g| = {last:.5f}",
        verdict(last > 0.999),
        "Beyond, the density is negative and has no integral. `schlick` takes |k| to 0.999.",
    )


def likeness_claim():
    """The distance, of which the thesis has no figure."""
    found = {g: figures(g) for g in (0.3, 0.9)}
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


def draw():
    """Both by g, and k over g."""
    drawn = figure(8, 2.8)
    left, right = drawn.subplots(1, 2)
    mu = np.linspace(-1, 1, POINTS)
    for g, colour in zip((0.3, 0.6, 0.9), ("#0072b2", "#e69f00", "#009e73"), strict=True):
        left.semilogy(mu, henyey_greenstein(g, mu), color=colour, linewidth=2.2, label=f"g = {g}")
        left.semilogy(mu, schlick(k_of(g), mu), color="#222222", linewidth=1)
    left.set_xlabel("μ")
    left.legend(fontsize=8)
    tidy(left, "", "p [sr⁻¹]")
    g = np.linspace(0.85, 1, POINTS)
    right.plot(g, k_of(g), color="#0072b2")
    right.axhspan(1, 1.005, color="#d55e00", alpha=0.25, linewidth=0)
    right.set_ylim(0.975, 1.005)
    right.set_xlabel("g")
    tidy(right, "", "k")
    return drawn
