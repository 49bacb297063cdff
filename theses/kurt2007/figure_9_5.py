"""Reproduces Figure 9.5, errors of Koenderink's basis and of the polynomial, each of two orders."""

import numpy as np
from brdfkit.theses.kurt2007.curet import BISQUARE, NUMBERS, OLS, WLS, compute_errors

from brdfkit.model import labels
from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.drawing import draw_curves, make_figure
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 25
WHERE = "Figure 9.5"
LINEAR = {
    "polynomial, degree 2": ("pca_polynomial:degree=2", BISQUARE),
    "Koenderink, order 2": ("koenderink:order=2", OLS),
    "Koenderink, order 8": ("koenderink:order=8", OLS),
    "polynomial, degree 8": ("pca_polynomial:degree=8", BISQUARE),
}
TEXT = """The polynomials by bisquare and Koenderink's basis by plain least squares, as the thesis
has them, sorted by the polynomial of degree 8; no scale is needed, all four are fitted to the
same data. *Least E*: by least squares weighted as eq. 5.13 weighs."""


def check_claims(sources, report):
    """Check the claims on Koenderink's basis and the polynomial; return their section."""
    as_thesis, least = {}, {}
    for done, (name, (label, how)) in enumerate(LINEAR.items()):
        as_thesis[name] = compute_errors(sources, label, how)
        least[name] = compute_errors(sources, label, WLS)
        report(done + 1, len(LINEAR))
    order = np.argsort(as_thesis["polynomial, degree 8"])
    drawn = make_figure(7.6, 3.6)
    curves = {name: e[order] for name, e in as_thesis.items()}
    draw_curves(drawn.add_subplot(), curves, "linear models", "E, one channel [sr⁻¹]")
    drawn.axes[0].set_xlabel("samples of CUReT, by the error of the polynomial of degree 8")
    drawn.legend(*drawn.axes[0].get_legend_handles_labels(), loc="outside right", frameon=False)
    lines = [(name, *(f"{np.median(e[name]):.4f}" for e in (as_thesis, least))) for name in LINEAR]
    table = Table(("median E over 52 samples", "as the thesis fits", "least E"), lines)
    claims = [
        _claim_degrees(as_thesis, least),
        _claim_koenderink(as_thesis, least),
        _claim_isotropic_counts(),
        _claim_anisotropic_counts(),
    ]
    picture = Picture("figure_9_5", drawn)
    return Section("Figure 9.5: the linear models by their order", TEXT, claims, [table], [picture])


def _count_lower(errors, first, second):
    return int((errors[first] < errors[second]).sum())


def _claim_degrees(as_thesis, least):
    poly = "polynomial, degree 8", "polynomial, degree 2"
    koenderink = "Koenderink, order 8", "Koenderink, order 2"
    counts = [_count_lower(e, *pair) for e in (as_thesis, least) for pair in (poly, koenderink)]
    return Claim(
        "More parameters describe the samples better.",
        WHERE,
        "8 below 2, for both",
        f"polynomial {counts[0]} of 52, Koenderink {counts[1]} of 52; by least E {counts[2]} and "
        f"{counts[3]}",
        to_verdict(min(counts[:2]) >= 0.9 * len(NUMBERS)),
        "In the samples that were fitted: 55 weights for 189 samples fit noise as well. By least E "
        "it cannot be otherwise, since the larger model contains the smaller. Where bisquare takes "
        "a highlight for outliers, a higher degree may have the larger E; confirmed "
        "from 90 % of the samples on.",
    )


def _claim_koenderink(as_thesis, least):
    pairs = [(f"Koenderink, order {n}", f"polynomial, degree {n}") for n in (2, 8)]
    counts = [_count_lower(e, *pair) for e in (as_thesis, least) for pair in pairs]
    return Claim(
        "Koenderink's basis has lower errors than the polynomial of the same order.",
        WHERE,
        "5 against 9 and 55 against 21 parameters; no count",
        f"order 2: {counts[0]} of 52, order 8: {counts[1]} of 52; by least E {counts[2]} and "
        f"{counts[3]}",
        UNSTATED,
        "The thesis shows curves and counts nothing; so the counts are ours alone.",
    )


def _claim_isotropic_counts():
    counts = [len(labels.model(f"koenderink:order={n}").weights()) for n in (2, 4, 8)]
    return Claim(
        "Koenderink's isotropic basis has 5, 14 and 55 parameters at orders 2, 4 and 8.",
        "3.1",
        "5 14 55",
        " ".join(map(str, counts)),
        to_verdict(counts == [5, 14, 55]),
        arithmetic=True,
    )


def _claim_anisotropic_counts():
    def count(order):
        return len(labels.model(f"koenderink:order={order},symmetry=anisotropic").weights())

    counts = [count(n) for n in (2, 4, 8)]
    return Claim(
        "Its anisotropic basis has 14, 55 and 295.",
        "3.1",
        "14 55 295",
        " ".join(map(str, counts)),
        to_verdict(counts == [14, 55, 295]),
        "No truncation of the reciprocal basis has these counts: 14 and 55 are those of the "
        "isotropic one at twice the order, whose next is 285.",
        arithmetic=True,
    )
