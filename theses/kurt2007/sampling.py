"""Checks what the thesis says of the sampling of BRDFs, by the variance of the estimates.

The variance of f cosθ / p, over the square of its mean, is computed by quadrature: it is the number
of samples that a relative error of 1 takes.
"""

from functools import cache

import numpy as np
from brdfkit.theses.kurt2007.curet import BISQUARE, NUMBERS, evaluate_lobes, load_sample

from brdfkit.core.geometry.directions import from_angles, normalize
from brdfkit.core.jit import double_precision
from brdfkit.model import labels
from brdfkit.model.evaluation import to_weight_matrix
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table

SECONDS = 15
ANGLES = 0, 30, 60, 75  # of the view [degrees]
WIDTHS = 0.1, 0.2, 0.3, 0.5  # α and m
POINTS = 300, 600  # of the quadrature, over θ and φ
ENOUGH, MOST = 1.0, 0.9  # relative variance, and share of the materials that have no more
POLYNOMIAL = "pca_polynomial:degree=7"
# The lobe of each model of a highlight, whose own sampling is compared with Lambert's
HIGHLIGHTS = {
    "Phong": ("phong", {"exponent": 50.0}),
    "Blinn-Phong": ("blinn_phong", {"exponent": 50.0}),
    "Lafortune": ("lafortune", {"c_x": -0.7, "c_y": -0.7, "c_z": 0.68, "exponent": 50.0}),
    "Ward": ("ward", {"alpha_u": 0.2, "alpha_v": 0.2}),
    "Ward-Dür": ("ward_duer", {"alpha_u": 0.2, "alpha_v": 0.2}),
    "Ashikhmin-Shirley": (
        "ashikhmin_shirley",
        {"exponent_u": 50.0, "exponent_v": 50.0, "f0": 0.5},
    ),
    "Cook-Torrance": ("cook_torrance", {"alpha": 0.2, "f0": 0.5}),
}
TEXT = f"""The variance of the estimate f cosθ / p of one sample, over the square of its mean, by
quadrature: the number of samples that a relative error of 1 takes, and a hundredth of the number
that a tenth takes. Samples below the horizon have the value 0. *Lambert*: p = cosθ / π, eq. 4.22;
*own*: cosⁿ about the lobe's axis (Phong, Lafortune), cosⁿ about the normal for the half vector
(Blinn-Phong, Ashikhmin-Shirley), or eq. 4.25 (Ward, Ward-Dür, and Cook-Torrance with m for α).
*Enough* is a variance of {ENOUGH:g} or less here, on {MOST:.0%} of the materials; the thesis tells
no figure. The polynomials are those of degree 7, by bisquare, on the 52 samples of CUReT."""


def check_claims(sources, report):
    """Check the claims on sampling; return their section of the page."""
    own = {(name, a): _compare_samplings(*HIGHLIGHTS[name], a) for name in HIGHLIGHTS
           for a in ANGLES}  # fmt: skip
    report(1, 4)
    ward = {
        (label, w, a): _compare_samplings(label, {"alpha_u": w, "alpha_v": w}, a)
        for label in ("ward", "ward_duer") for w in WIDTHS for a in ANGLES
    }  # fmt: skip
    report(2, 4)
    polynomials = _measure_polynomials([load_sample(sources, n) for n in NUMBERS])
    report(3, 4)
    lines = [
        (name, *(f"{own[name, a][0]:.2f} / {own[name, a][1]:.1f}" for a in ANGLES))
        for name in HIGHLIGHTS
    ]
    heads = "variance, own / Lambert's", *(f"view at {a}°" for a in ANGLES)
    claims = [
        _claim_own(own),
        _claim_ward(ward),
        _claim_lambert(polynomials, ward),
        _claim_cook(own),
        _claim_density(),
    ]
    caption = "The highlight alone: n = 50, α = m = 0.2, F₀ = 0.5."
    tables = [Table(heads, lines, caption), _make_lambert_table(polynomials, ward)]
    return Section("Chapter 4: sampling", TEXT, claims, tables)


@cache
def _make_quadrature():
    """Return directions (n, 3) above the surface, and their solid angles (n,)."""
    rows, columns = POINTS
    edges = np.linspace(0, np.pi / 2, rows + 1)
    theta, phi = (edges[1:] + edges[:-1]) / 2, (np.arange(columns) + 0.5) * 2 * np.pi / columns
    solid = np.repeat(-np.diff(np.cos(edges)) * 2 * np.pi / columns, columns)
    return from_angles(theta[:, None], phi).reshape(-1, 3), solid


def _compute_variance(values, densities, solid):
    """Return the variance of values / densities over the squared mean; values (n,) have cosines."""
    used = values > 0
    squares = values[used] ** 2 / np.maximum(densities[used], 1e-300)
    return max(0.0, float(squares @ solid[used] / (values @ solid) ** 2 - 1))


def _compute_eq_4_25(width, wi, wo):
    """Return the density (n,) [sr⁻¹] of eq. 4.25 at directions (n, 3), by which Ward is sampled."""
    h = normalize(wi + wo)
    tangent = (h[:, 0] ** 2 + h[:, 1] ** 2) / h[:, 2] ** 2
    below = 4 * np.pi * width**2 * (h * wi).sum(axis=1) * h[:, 2] ** 3
    return np.exp(-tangent / width**2) / below


@cache
def _evaluate_highlight(label, shapes, angle):
    """Return f cosθ and the density of its own sampling (n,), at a view's angle [degrees]."""
    wo, _ = _make_quadrature()
    wi = np.broadcast_to(from_angles(np.radians(angle), 0.0), wo.shape)
    bound = labels.model(label).bind({n: double_precision.to_scalar(v) for n, v in shapes})
    first, second = (double_precision.to_vector(w) for w in (wi, wo))
    _, lobe = bound.terms()[1]
    values = np.asarray(lobe.eval(first, second)) * wo[:, 2]
    width = dict(shapes).get("alpha_u", dict(shapes).get("alpha"))
    if width is None:
        return values, np.asarray(lobe.sampling.pdf(first, second))
    return values, _compute_eq_4_25(width, wi, wo)


def _compare_samplings(label, shapes, angle):
    """Return the variances of a model's highlight by its own sampling, and by Lambert's."""
    wo, solid = _make_quadrature()
    values, own = _evaluate_highlight(label, tuple(shapes.items()), angle)
    return tuple(_compute_variance(values, p, solid) for p in (own, wo[:, 2] / np.pi))


def _measure_polynomials(samples):
    """Return the variances (material, angle) of the samples' polynomials by Lambert's sampling."""
    wo, solid = _make_quadrature()
    models = [data.fit(POLYNOMIAL, BISQUARE).model for data in samples]
    weights = np.stack([to_weight_matrix(model)[:, 0] for model in models], axis=1)
    turned = {"angle_1_2": models[0].values["angle_1_2"]}  # all have the same directions
    found = []
    for angle in ANGLES:
        wi = np.broadcast_to(from_angles(np.radians(angle), 0.0), wo.shape)
        lobes = evaluate_lobes(POLYNOMIAL, turned, wi, wo)
        values = np.maximum(lobes @ weights, 0) * wo[:, 2:]
        found.append([_compute_variance(v, wo[:, 2] / np.pi, solid) for v in values.T])
    return np.array(found).T


def _make_lambert_table(polynomials, ward):
    """Return the table of the cells over which Lambert's sampling is judged."""
    lines = [
        (
            "polynomials: share with 1 or less",
            *(f"{s:.0%}" for s in (polynomials <= ENOUGH).mean(axis=0)),
        ),
        ("polynomials: median", *(f"{v:.2f}" for v in np.median(polynomials, axis=0))),
        *((f"Ward, α = {w}", *(f"{ward['ward', w, a][1]:.2f}" for a in ANGLES)) for w in WIDTHS),
    ]
    return Table(("variance by Lambert's sampling", *(f"view at {a}°" for a in ANGLES)), lines)


def _claim_own(own):
    holds = {(name, f"{a}°"): v[0] < v[1] for (name, a), v in own.items()}
    ours, verdict = judge_over_grid(["model", "view"], holds)
    ranges = [[v[k] for v in own.values()] for k in (0, 1)]
    return Claim(
        "A density that resembles the BRDF has less variance than Lambert's.",
        "eq. 4.14",
        "importance sampling",
        f"{ours}: at most {max(ranges[0]):.2f}, Lambert's {min(ranges[1]):.1f} to "
        f"{max(ranges[1]):.0f}",
        verdict,
        "Of the highlights alone, each by the sampling of its own model.",
    )


def _claim_ward(ward):
    pairs = {
        (f"{w}", f"{a}°"): (ward["ward_duer", w, a][0], ward["ward", w, a][0])
        for w in WIDTHS for a in ANGLES
    }  # fmt: skip
    ours, verdict = judge_over_grid(
        ["width α", "view"], {cell: duer < plain for cell, (duer, plain) in pairs.items()}
    )
    ratios = [duer / plain for duer, plain in pairs.values()]
    return Claim(
        "Ward's sampling fits Ward-Dür better than Ward.",
        "3.1, eq. 4.25",
        "so by Dür",
        f"{ours}: variance {min(ratios):.2f} to {max(ratios):.2f} times Ward's",
        verdict,
        "The weight of a sample is k_s (V·H) (N·H)³ times 1 / (N·V) for Ward-Dür, and √((N·L) / "
        "(N·V)) for Ward.",
    )


def _claim_lambert(polynomials, ward):
    glossy = {a: [ward["ward", w, a][1] for w in WIDTHS] for a in ANGLES}
    share = (polynomials <= ENOUGH).mean(axis=0)
    holds = {
        ("that of the polynomials", f"{a}°"): bool(s >= MOST)
        for a, s in zip(ANGLES, share, strict=True)
    }
    holds |= {
        (f"Ward's with α = {w}", f"{a}°"): glossy[a][k] <= ENOUGH
        for k, w in enumerate(WIDTHS)
        for a in ANGLES
    }
    ours, verdict = judge_over_grid(["BRDF", "view"], holds)
    return Claim(
        "Lambert's sampling is enough for diffuse and glossy materials.",
        "7",
        "so the polynomial is rendered",
        f"{ours}: variance of the polynomials {np.median(polynomials):.2f} (median), up to "
        f"{polynomials.max():.1f}; of Ward's highlight {glossy[0][-1]:.1f} to {glossy[0][0]:.0f} "
        "at 0°",
        verdict,
        "Enough for the polynomials, whose highlights are low and wide; not for gloss itself: see "
        "the second table.",
    )


def _claim_cook(own):
    found = [v for (name, _), v in own.items() if name == "Cook-Torrance"]
    worst, others = max(v[0] for v in found), [v[1] for v in found]
    return Claim(
        "Cook-Torrance has no sampling method.",
        "3.2",
        "no method",
        f"by its facets the variance is up to {worst:.2f}, by Lambert's {min(others):.1f} to "
        f"{max(others):.0f}",
        to_verdict(worst > ENOUGH),
        "The whole product has no inverse, as the thesis says; but the normals of the facets are "
        "drawn by tan²θ_h = -m² ln ξ, which leaves smooth factors.",
    )


def _claim_density():
    _, solid = _make_quadrature()
    sums = {
        (w, a): float(_evaluate_highlight("ward", (("alpha_u", w), ("alpha_v", w)), a)[1] @ solid)
        for w in WIDTHS for a in ANGLES
    }  # fmt: skip
    (width, angle), least = min(sums.items(), key=lambda item: item[1])
    return Claim(
        "Eq. 4.25 is the density of directions above the surface.",
        "eq. 4.25",
        "integral 1",
        f"{sums[0.2, 0]:.4f} (α = 0.2, 0°), {sums[0.2, 60]:.4f} (60°), least {least:.3f} "
        f"(α = {width}, {angle}°)",
        to_verdict(abs(least - 1) < 1e-3),
        "It integrates to 1 over the whole sphere: the rest are samples below the horizon.",
        arithmetic=True,
    )
