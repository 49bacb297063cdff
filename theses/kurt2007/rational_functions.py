"""Fits rational functions to CUReT, rivals of the polynomial with as many coefficients.

They are no model of the thesis; Pacanowski et al. (Rational BRDF, 2012) and ALTA fit by them.
"""

import numpy as np
from brdfkit.theses.kurt2007.curet import NUMBERS, load_sample
from scipy.optimize import least_squares

from brdfkit.core.geometry.directions import from_angles, normalize
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 30
SAMPLES = NUMBERS[::2]
FOLDS, STEPS = 5, 60
LEAST = 0.05  # the denominator is kept above this all over the hemisphere, where it is 1 at z = 0
FIRM = 10.0  # weight of the denominators that are not, over the scatter of the measured values
SHAPES = (7, 0), (6, 1), (4, 3)  # degrees above and below: 15 coefficients each
TEXT = f"""f = P / (1 + Q), with P and Q polynomials of two variables without interactions, 15
coefficients in all, as the polynomial of degree 7 has: of the thesis's W₁ and W₂, which its
principal components are within 2°, and of cos²θ_h and cos²θ_d, by the half vector and half the
angle between light and view. By Levenberg-Marquardt of the E of eq. 5.13; the denominator is kept
above {LEAST:g} all over the hemisphere, so that there is no pole. On {len(SAMPLES)} samples of
CUReT, each second of the 52, to save time. *Left out*: the values of each {FOLDS}th of
a sample against the fit to the rest."""


def check_claims(sources, report):
    """Compare rational functions with the polynomial; return the section."""
    errors = {(name, shape): [] for name in VARIABLES for shape in SHAPES}
    for done, number in enumerate(SAMPLES, 1):
        data = load_sample(sources, number)
        for name, compute in VARIABLES.items():
            z, everywhere = compute(data.wi, data.wo), compute(*_list_directions())
            for shape in SHAPES:
                errors[name, shape].append(_fit_sample(data, z, everywhere, shape))
        report(done, len(SAMPLES))
    errors = {key: np.array(e) for key, e in errors.items()}
    lines = []
    for (name, (above, below)), e in errors.items():
        kind = f"rational, {above} over {below}" if below else f"polynomial, p = {above}"
        lines.append((kind, name, *(f"{v:.4f}" for v in np.median(e, axis=0))))
    table = Table((f"median E of {len(SAMPLES)}", "variables", "least E", "left out"), lines)
    claim = _claim_fewest(errors)
    return Section("Rivals: rational functions", TEXT, [claim], [table])


def _multiply(wi, wo):
    """Return W₁ and W₂ (n, 2) of pairs of directions."""
    return np.stack([(wi * wo)[:, :2].sum(axis=1), wi[:, 2] * wo[:, 2]], axis=1)


def _halve(wi, wo):
    """Return cos²θ_h and cos²θ_d (n, 2) of pairs of directions."""
    half = normalize(wi + wo)
    return np.stack([half[:, 2], (half * wi).sum(axis=1)], axis=1) ** 2


VARIABLES = {"W₁, W₂": _multiply, "cos²θ_h, cos²θ_d": _halve}


def _list_directions():
    """Return pairs of directions (n, 3) all over the upper hemisphere."""
    theta, phi = np.radians(np.arange(0, 90, 8)), np.radians(np.arange(0, 181, 20))
    first, second, third = np.meshgrid(theta, theta, phi, indexing="ij")
    return from_angles(first.ravel(), 0 * third.ravel()), from_angles(second.ravel(), third.ravel())


def _make_powers(z, degree):
    return np.concatenate([np.ones((len(z), 1)), *(z**k for k in range(1, degree + 1))], axis=1)


def _fit_sample(data, z, everywhere, shape):
    """Return the least E of a rational function, and E of values left out of its fits."""
    root = np.sqrt(data.weights / data.weights.sum()) * data.cosines
    above, below = (_make_powers(z, degree) for degree in shape)
    poles = _make_powers(everywhere, shape[1])[:, 1:]
    every = np.arange(len(z))

    def compute_residuals(used, others):
        fitted = fit_rational(above[used], below[used, 1:], data.values[used], root[used], poles)
        numerator, denominator = fitted
        values = above[others] @ numerator / (1 + below[others, 1:] @ denominator)
        return (values - data.values[others]) * root[others]

    least = compute_residuals(every, every)
    apart = [compute_residuals(every % FOLDS != f, every % FOLDS == f) for f in range(FOLDS)]
    return np.linalg.norm(least), np.linalg.norm(np.concatenate(apart))


def fit_rational(above, below, values, root, poles):
    """Return the coefficients of numerator and denominator with the least weighted squares.

    above, below : columns (n, a), with a constant, and (n, b), without.
    values, root : what is fitted (n,), and the roots of its weights.
    poles : columns (m, b) as `below` at directions where the denominator has to stay above `LEAST`.
    """
    linear = np.linalg.lstsq(above * root[:, None], values * root, rcond=None)[0]
    if not below.shape[1]:
        return linear, np.zeros(0)
    split, firm = above.shape[1], FIRM * np.std(values * root)

    def compute_residuals(x):
        divisor, room = 1 + below @ x[split:], 1 + poles @ x[split:] - LEAST
        residuals = (above @ x[:split] / _keep_from_zero(divisor) - values) * root
        return np.concatenate([residuals, firm * np.minimum(room, 0)])

    def compute_slopes(x):
        divisor, room = _keep_from_zero(1 + below @ x[split:]), 1 + poles @ x[split:] - LEAST
        first = above / divisor[:, None]
        second = -(first @ x[:split] / divisor)[:, None] * below
        fitted = np.concatenate([first, second], axis=1) * root[:, None]
        kept = np.concatenate(
            [np.zeros((len(poles), split)), firm * poles * (room < 0)[:, None]], axis=1
        )
        return np.concatenate([fitted, kept])

    start = np.concatenate([linear, np.zeros(below.shape[1])])
    end = least_squares(compute_residuals, start, compute_slopes, method="lm", max_nfev=STEPS).x
    return end[:split], end[split:]


def _keep_from_zero(divisor):
    return np.where(np.abs(divisor) < LEAST / 10, LEAST / 10, divisor)


def _claim_fewest(errors):
    names = list(VARIABLES)
    polynomial = errors[names[0], SHAPES[0]]
    ratios = {key: e / polynomial for key, e in errors.items() if key != (names[0], SHAPES[0])}
    best = min(ratios, key=lambda key: np.median(ratios[key][:, 1]))
    wins, medians = (ratios[best] < 1).sum(axis=0), np.median(ratios[best], axis=0)
    other = np.median(ratios[names[1], SHAPES[0]], axis=0)
    (above, below), n = best[1], len(SAMPLES)
    return Claim(
        "The polynomial represents BRDFs with as few parameters as possible.",
        "9.2",
        "the fewest",
        f"a rational function, {above} over {below}, of {best[0]}, with as many: E lower on "
        f"{wins[0]} of {n}, of values left out on {wins[1]}; {medians[0]:.2f} and {medians[1]:.2f} "
        "times as large (medians)",
        to_verdict(medians.max() >= 1),
        "The polynomial has 49 numbers for three channels at p = 7, 3 × 15 and the 4 of its "
        "components, where the seven models have 7 to 9. The rival is that whose values left "
        "out are best in the median; not confirmed if both medians "
        f"are below 1. The polynomial itself, of {names[1]} in place of the products of "
        f"components, has {other[0]:.2f} and {other[1]:.2f} times the E.",
    )
