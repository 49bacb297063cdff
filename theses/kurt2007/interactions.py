"""Defines the polynomial with terms of interaction, eq. 7.3, and compares it with that without.

The thesis leaves the interactions out, because its components are orthogonal.
"""

import math
from functools import cache

import numpy as np
from brdfkit.theses.kurt2007.curet import BISQUARE, WLS, load_samples

from brdfkit.model import labels, weight
from brdfkit.model.evaluation import compute_lobe_values
from brdfkit.model.lobes import Cosine, Lobe
from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table

SECONDS = 15
# Models of nearly equal numbers of coefficients: the degrees without and with interactions
PAIRS = (4, 3), (7, 4)
WAYS = {"bisquare": BISQUARE, "least E": WLS}
LEFT_OUT = "left out"
TEXT = """Eq. 7.3, before its interactions are dropped, of the two isotropic components: all
Z₁ʲ Z₂ᵏ with j + k ≤ p. It is compared at equal numbers of coefficients, and not only of the same
degree, where it cannot be worse by least E. *Left out*: E of each measured value against the fit
without it, by the weights of eq. 5.13, which does not reward the fitting of noise."""


def check_claims(sources, report):
    """Check the claims on terms of interaction; return their section of the page."""
    samples = load_samples(sources).values()
    models = {}
    for apart, full in PAIRS:
        models[f"p = {apart}, without"] = labels.model(f"pca_polynomial:degree={apart}")
        models[f"p = {full}, with"] = make_interacting_model(full)
    errors = {}
    for done, (name, model) in enumerate(models.items(), 1):
        for way, how in WAYS.items():
            errors[name, way] = np.array([data.compute_error(model, how) for data in samples])
        errors[name, LEFT_OUT] = np.array([leave_each_out(data, model) for data in samples])
        report(done, len(models))
    columns = *WAYS, LEFT_OUT
    lines = [
        (name, str(len(model.weights())), *(f"{np.median(errors[name, c]):.4f}" for c in columns))
        for name, model in models.items()
    ]
    table = Table(("median E of 52", "coefficients", *columns), lines)
    claims = [_claim_interactions(errors, list(models)), _claim_growth()]
    return Section("Chapter 7: terms of interaction", TEXT, claims, [table])


@cache
def make_interacting_model(degree):
    """Return the class of the polynomial of Z₁ and Z₂ with all terms of a degree, eq. 7.3."""
    base = labels.model(f"pca_polynomial:degree={degree}")
    exponents = [(j, n - j) for n in range(1, degree + 1) for j in range(n, -1, -1)]

    def list_more_parameters(cls):
        (angle,) = cls.list_angle_names()
        signed = (-math.inf, math.inf)
        betas = {
            f"beta_{n}": weight(0.0, f"weight of Z₁^{j} Z₂^{k}", signed)
            for n, (j, k) in enumerate(exponents, 1)
        }
        given = base.more_parameters()
        return {"beta_0": given["beta_0"], **betas, angle: given[angle]}

    def list_lobes(self):
        cosine = Cosine()
        constant, first, second, *_ = base.lobes(self)

        def make_product(j, k):
            return Lobe(
                lambda wi, wo: first.eval(wi, wo) ** j * second.eval(wi, wo) ** k,
                cosine,
                lambda wi: 0.0,
                diffuse=True,
            )

        return constant, *(make_product(j, k) for j, k in exponents)

    methods = {"more_parameters": classmethod(list_more_parameters), "lobes": list_lobes}
    return type(f"InteractingPolynomial{degree}", (base,), methods)


def leave_each_out(data, model):
    """Return E of the values of a `Sample`, each against the fit of a linear model to the others.

    The fit has least E. By the leverage h of a value its residual without it is 1 / (1 - h) of that
    with it.
    """
    plain, _ = compute_lobe_values(data.fit(model, WLS).model, data.wi, data.wo)
    columns, targets = data.weigh_by_root(np.asarray(plain))
    basis, _ = np.linalg.qr(columns)
    residuals = (targets - basis @ (basis.T @ targets)) / (1 - (basis**2).sum(axis=1))
    return float(np.sqrt(residuals @ residuals / data.weights.sum()))


def _claim_interactions(errors, names):
    ratios = {
        (f"{apart} or {full}", c): errors[full, c] / errors[apart, c]
        for apart, full in zip(names[::2], names[1::2], strict=True)
        for c in (*WAYS, LEFT_OUT)
    }
    ours, _ = judge_over_grid(
        ["polynomial", "E"], {cell: bool(np.median(r) > 1) for cell, r in ratios.items()}
    )
    last = [r for (pair, _), r in ratios.items() if pair.endswith(names[-1])]
    counts = ", ".join(
        f"{(r > 1).sum()} ({c})" for r, c in zip(last, (*WAYS, LEFT_OUT), strict=True)
    )
    return Claim(
        "A polynomial without interactions describes the samples better than one with them.",
        "eqs. 7.3, 7.5",
        "interactions are dropped",
        f"{ours}; with 15 coefficients each on {counts} of 52",
        UNSTATED,
        "The thesis compares no two such polynomials: it drops the interactions because they "
        "vanish, which they do not (Figure 7.1). Ours, at about equal numbers of coefficients: E "
        "with interactions is "
        f"{min(np.median(r) for r in last):.2f} to {max(np.median(r) for r in last):.2f} times as "
        "large, with 15 each (medians). So higher powers are worth more.",
    )


def _claim_growth():
    counts = [math.comb(p + 3, 3) for p in range(1, 17)]
    return Claim(
        "The number of coefficients of eq. 7.3 grows exponentially with the degree.",
        "7",
        "exponentially",
        f"{counts[0]}, {counts[1]}, {counts[3]}, {counts[7]}, {counts[15]} at p = 1, 2, 4, 8, 16",
        to_verdict(counts[-1] / counts[-2] >= counts[1] / counts[0]),
        "(p + 3)! / (p! 3!) for three variables: as the cube of the degree.",
        arithmetic=True,
    )
