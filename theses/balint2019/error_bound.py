"""Checks that ε bounds the error of a march (section 4.1), but not of the algorithms as printed."""

from math import pi

import numpy as np
from brdfkit.theses.balint2019.dense import compute_dense_shadow
from brdfkit.theses.balint2019.rivals import invert_tau
from brdfkit.theses.balint2019.scenes import MARCHES
from drjit.llvm import Array3f64, Float64

from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields import box, plane, sphere, union
from brdfkit.distance_fields.shadows import make_light_cone
from brdfkit.distance_fields.shadows.march import Rule
from brdfkit.distance_fields.shadows.shadow import trace_shadow
from brdfkit.distance_fields.shadows.tau import lit_disc_share
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table

SECONDS = 10
CONES, PRINTED_CONES, SAMPLES = 4000, 300, 1000
EPSILONS = 10, 30, 256  # values of 1 / ε
ONE_SIDED = "base", "linear", "convex"  # marches that never make a shadow too dark
MEASURES = "the mean", "that of 1 in 100", "the largest"
ROUNDING = 2e-5  # the error of the dense search
TEXT = f"""{CONES:,} cones towards lights of radius 0, 0.2, 1, 2 and 4, about 6 away; in each a
random sphere, a random box and a ground. The error of a march is its share of the light less
τ(r_min), by a dense search along the axis. Its unit is ε, of ε = 1/10, 1/30 and 1/256 in both
directions."""
FIXED = (
    "As printed, R_T becomes f over the radius of the cone of R_T itself, which is right for the "
    "first time only; and algorithm 4 ends at R_T = e, at half shadow. Here R_T is f over the "
    "radius of the whole cone, and the end is e - 1. At ε = 1/256 an error of 255 ε is the "
    "whole light, and one of 129 ε a half."
)


@in_turn
def check_claims(sources, report):
    """Check the claims on the largest error of a march; return their section of the page."""
    rng = np.random.default_rng(0)
    field, cone = make_random_scenes(rng, CONES)
    model = np.array(compute_dense_shadow(field, cone, SAMPLES).visible)
    shares = {name: compute_shares(march, field, cone) for name, march in MARCHES.items()}
    found = {name: divide_by_epsilon(s - model) for name, s in shares.items()}
    report(1, 2)
    few, few_cones = make_random_scenes(rng, PRINTED_CONES)
    few_model = np.array(compute_dense_shadow(few, few_cones, SAMPLES).visible)
    printed = {
        name: divide_by_epsilon(compute_shares(march, few, few_cones) - few_model)
        for name, march in AS_PRINTED.items()
    }
    partly = (model > 0) & (model < 1)
    rows = [(name, *format_figures(errors, partly)) for name, errors in found.items()]
    few_partly = (few_model > 0) & (few_model < 1)
    rows += [(name, *format_figures(errors, few_partly)) for name, errors in printed.items()]
    claims = [
        claim_bound(found),
        claim_discrete(found["discrete"]),
        claim_order(found, partly),
        claim_direction(
            [divide_by_epsilon(np.ptp(shares[name], axis=1)).max() for name in ONE_SIDED]
        ),
        claim_printed(printed),
    ]
    heads = "", "least", "largest", "mean of partly lit", "1 in 100 above"
    caption = f"Errors over ε. As printed: {PRINTED_CONES} cones, for most marches never end."
    return Section("The error of a march", TEXT, claims, [Table(heads, rows, caption)])


def compute_shares(march, field, cone):
    """Return the shares of the light (ε, direction, cone) that a march finds, by error bound ε."""
    return np.array([[march(field, cone, 1 / n, d).visible for d in "AB"] for n in EPSILONS], float)


def divide_by_epsilon(values):
    """Return values (ε, ...) in units of their ε, the error bound of a march."""
    return np.array([n * v for n, v in zip(EPSILONS, values, strict=True)])


def format_figures(errors, partly):
    """Return the least, the largest, the mean and the 99th percentile of errors, as texts.

    Means and percentiles are over partly lit points.
    """
    some = np.abs(errors[..., partly])
    shown = np.nanmin(errors), np.nanmax(errors), np.nanmean(some), np.nanpercentile(some, 99)
    return tuple(f"{value + 0.0:.3f}".replace("-0.000", "0.000") for value in shown)


def is_within(errors, low=0):
    """Return whether errors (ε, ...), in units of their error bound ε, are between `low` and 1."""
    rounding = ROUNDING * np.reshape(EPSILONS, (-1, 1, 1))
    return bool(((errors >= low - rounding) & (errors <= 1 + rounding)).all())


def claim_bound(found):
    """Claim that ε is the largest error of a march, and that no shadow is too dark."""
    errors = {name: found[name] for name in ONE_SIDED}
    ours = (f"{name} {e.min() + 0.0:.2f} to {e.max():.2f}" for name, e in errors.items())
    return Claim(
        "ε is the largest error of the share against τ(r_min).",
        "4.1",
        "0 to 1 ε",
        "; ".join(ours).replace("-0.00", "0.00"),
        to_verdict(all(map(is_within, errors.values()))),
        "The thesis states it without a proof. One follows from the steps: no ratio below R_C is "
        "passed. It never makes a shadow too dark.",
    )


def claim_discrete(errors):
    """Claim that the error bound ε holds for the march `discrete` in both directions of error."""
    return Claim(
        "`discrete` is off by ε at most, too bright or too dark.",
        "4.2",
        "-1 to 1 ε",
        f"{errors.min():.2f} to {errors.max():.2f}",
        to_verdict(is_within(errors, -1)),
    )


def claim_order(found, partly):
    """Claim that the error of a march is an order of magnitude smaller than its bound ε."""
    cells = {}
    for name, errors in found.items():
        some = np.abs(errors[..., partly])
        figures = some.mean(), np.percentile(some, 99), some.max()
        cells |= {(name, what): value for what, value in zip(MEASURES, figures, strict=True)}
    ours, verdict = judge_over_grid(("march", "error"), {c: v < 0.1 for c, v in cells.items()})
    means = ", ".join(f"{name} {cells[name, MEASURES[0]]:.3f}" for name in found)
    return Claim(
        "In practice the error is smaller than ε by an order of magnitude at least.",
        "6.3",
        "below 0.1 ε",
        f"means of {means} ε; {ours}",
        verdict,
        "The thesis does not say of which error; section 6.3 is by `linear`. Errors are those of "
        "partly lit points: the mean, the one that 1 in 100 exceeds, and the largest. In the "
        "scene of section 6.3 below, the largest of `linear` is 0.3 to 0.4 ε.",
    )


def claim_direction(apart):
    """Claim that both directions of marching agree to their error bound ε.

    `apart` holds the differences in units of ε.
    """
    return Claim(
        "From the surface or from the light, a march finds the same to within ε.",
        "4.1",
        "at most 1 ε apart",
        f"{max(apart):.2f} ε at most",
        to_verdict(max(apart) <= 1 + 2 * ROUNDING * max(EPSILONS)),
    )


def claim_printed(found):
    """Claim that the algorithms as printed keep the bound."""
    worst = {name: np.nanmax(np.abs(errors)) for name, errors in found.items()}
    return Claim(
        "Algorithms 3 and 4 keep the bound as they are printed.",
        "Algorithms 3, 4",
        "1 ε",
        "; ".join(f"{name.replace(', as printed', '')}: {w:.0f} ε" for name, w in worst.items()),
        to_verdict(all(w <= 1 for w in worst.values())),
        FIXED,
    )


def march_base_as_printed(field, cone, epsilon, direction):
    """Compute a shadow by the thesis's algorithm 3 as printed, with a wrong ratio."""

    def lower(ratio, R_T):
        return ratio / R_T, invert_tau(lit_disc_share(ratio / R_T) - epsilon)

    rule = Rule((1.0, invert_tau(1 - epsilon)), lower, invert_tau(epsilon))
    return trace_shadow(field, cone, rule, epsilon, direction)


def march_linear_as_printed(field, cone, epsilon, direction):
    """Compute a shadow by the thesis's algorithm 4 as printed, with a wrong ratio and end."""
    e = epsilon * pi / 2
    rule = Rule((1.0, 1 - e), lambda ratio, R_T: (ratio / R_T, ratio / R_T - e), e)
    return trace_shadow(field, cone, rule, epsilon, direction)


def march_linear_to_half(field, cone, epsilon, direction):
    """Compute a shadow by the thesis's algorithm 4 with the right ratio, but the end as printed."""
    e = epsilon * pi / 2
    rule = Rule((1.0, 1 - e), lambda ratio, R_T: (ratio, ratio - e), e)
    return trace_shadow(field, cone, rule, epsilon, direction)


def make_random_scenes(rng, n):
    """Return a field whose parameters are arrays over n cones, and the cones."""
    places = (np.column_stack([rng.normal(0, 0.7, (n, 2)), rng.uniform(0.5, 6, n)]) for _ in "ab")
    ball = sphere(Float64(rng.uniform(0.02, 1, n))).translate(to_vectors(next(places)))
    block = box(to_vectors(rng.uniform(0.04, 2, (n, 3)))).translate(to_vectors(next(places)))
    start = to_vectors(rng.normal(0, 0.1, (n, 3)))
    light = to_vectors(rng.normal((0, 0, 6), 0.3, (n, 3)))
    radius, empty = rng.choice([0.0, 0.2, 1.0, 2.0, 4.0], n), rng.uniform(0.005, 0.05, n)
    cone = make_light_cone(start, light, Float64(radius), Float64(empty))
    return union((ball, block, plane().at(0, 0, -0.2))), cone


def to_vectors(values):
    """Return points (n, 3) as a vector of Dr.Jit's arrays."""
    return Array3f64(*(Float64(np.ascontiguousarray(column)) for column in values.T))


AS_PRINTED = {
    "base, as printed": march_base_as_printed,
    "linear, as printed": march_linear_as_printed,
    "linear, its end as printed": march_linear_to_half,
}
