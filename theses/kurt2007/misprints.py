"""Computes formulas and a figure of the thesis as printed and as they must be meant."""

from statistics import NormalDist

import numpy as np
from brdfkit.theses.kurt2007.printed import read_printed_table

from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section

SECONDS = 1
TEXT = """Each is computed as printed and as it must be meant; *not confirmed* is what fails as
printed. brdfkit computes what is meant."""


def check_claims(sources, report):
    """Check the claims on misprinted formulas; return their section of the page."""
    claims = [
        _claim_rough_diffuse(),
        _claim_two_samplings(),
        _claim_scale_of_noise(),
        _claim_half_angles(),
        _claim_picture(),
    ]
    report(1, 1)
    return Section("Misprints", TEXT, claims)


def _claim_misprint(says, where, printed, ours, holds, why):
    return Claim(says, where, printed, ours, to_verdict(holds), why, arithmetic=True)


def _claim_rough_diffuse():
    """Claim on the short form of Oren-Nayar, whose bracket closes too early in print."""
    a, b, towards, sine_tangent = 1.0, 0.0, 0.0, 0.0  # σ = 0, along the normal
    printed, meant = (a + b * towards) * sine_tangent, a + b * towards * sine_tangent
    return _claim_misprint(
        "At σ = 0 Oren-Nayar is Lambert's model.",
        "eq. 3.23",
        "k_d / π",
        f"{printed:g} k_d / π along the normal; as it is meant {meant:g} k_d / π",
        printed == 1,
        "(A + B max(0, cosΔφ)) sinα tanβ closes the bracket too early: it is A + B max(0, cosΔφ) "
        "sinα tanβ. On CUReT the printed one has 1.9 times the printed errors.",
    )


def _claim_two_samplings():
    """Claim on multiple importance sampling, of ∫ 3x² (1 + x) dx by the densities 3x² and 1."""
    x = (np.arange(100_000) + 0.5) / 100_000
    densities, counts, f = (
        np.stack([3 * x**2, np.ones_like(x)]),
        np.array([1, 1]),
        3 * x**2 + 3 * x**3,
    )
    weights = counts[:, None] * densities / (counts @ densities)
    each = (f * weights).mean(axis=1)  # the mean of f w / p over the samples of a density p
    printed, meant = counts @ each / counts.sum(), each.sum()
    return _claim_misprint(
        "Multiple importance sampling has the integral as its mean.",
        "eqs. 4.16, 4.18",
        "1.75",
        f"{printed:.3f}, with one sample each; as it is meant {meant:.3f}",
        abs(printed - 1.75) < 1e-4,
        "The factor 1 / (n_f + n_g) before both sums is one too many beside the weights: each sum "
        "is divided by its own number of samples.",
    )


def _claim_scale_of_noise():
    """Claim on the scale of residuals, of Gaussian noise with a standard deviation of 1."""
    noise = np.array([NormalDist().inv_cdf(p) for p in (np.arange(20_000) + 0.5) / 20_000])
    printed = np.abs(noise - noise.mean()).mean() / 0.6745
    meant = np.median(np.abs(noise)) / 0.6745
    return _claim_misprint(
        "s = MAD / 0.6745 is the standard deviation of Gaussian noise.",
        "eq. 5.15",
        "1",
        f"{printed:.3f} by the text; as it is meant {meant:.3f}",
        abs(printed - 1) < 1e-3,
        "The text calls MAD the mean deviation from the mean; 0.6745 belongs to the median of the "
        "absolute deviations, and MATLAB's `robustfit`, which the thesis ran, takes this.",
    )


def _claim_half_angles():
    """Claim on the half angles of MERL's cells."""
    cells = np.arange(91)
    printed, meant = 0.2 * 1.07**cells, 90 * (cells / 90) ** 2
    off = np.abs(printed - meant)
    return _claim_misprint(
        "θ_h of a cell in MERL's tables is 0.2° · 1.07ⁿ.",
        "eq. 8.1",
        "n = 0 to 90: 0° to 90°",
        f"{printed[0]:.1f}° to {printed[-1]:.1f}°, off by up to {off.max():.1f}°",
        off.max() < 0.1,
        "The published files have θ_h = 90° (n / 90)². No fit here reads MERL's own tables.",
    )


def _claim_picture():
    """Claim on a PSNR of Table 9.3 that is printed twice."""
    table = read_printed_table("table_9_3")
    column = table["materials"].index("orange-paint")
    psnr, errors = (
        [np.array(table[key][name]) for name in ("Ward-Dür", "Ward")] for key in ("psnr", "errors")
    )
    gains = np.delete(psnr[0] - psnr[1], column)
    return _claim_misprint(
        "The PSNR of orange-paint by Ward-Dür.",
        "Table 9.3",
        f"{psnr[0][column]:.2f} and {psnr[1][column]:.2f} dB",
        f"E {errors[0][column]:.3f} and {errors[1][column]:.3f}; on the others Ward-Dür is better "
        f"by {gains.min():.1f} to {gains.max():.1f} dB",
        psnr[0][column] != psnr[1][column],
        "Equal to the last digit where the errors are not: probably copied from the row above.",
    )
