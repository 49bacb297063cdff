"""Defines phase functions over the cosine μ of the deflection, from plugins and from formulas."""

import numpy as np
from scipy.optimize import least_squares

from brdfkit.mitsuba_bridge import phase_functions

PLUGINS = {
    "Henyey-Greenstein 0.6": {"type": "hg", "g": 0.6},
    "Henyey-Greenstein -0.3": {"type": "hg", "g": -0.3},
    "Schlick 0.8112": {"type": "schlick", "k": 0.8112},
    "Schlick 0.45015": {"type": "schlick", "k": 0.45015},
    "Rayleigh": {"type": "rayleigh"},
    "Mie hazy": {"type": "mie_hazy"},
    "Mie murky": {"type": "mie_murky"},
}
POINTS = 200  # of the quadrature over μ


def make_phase_function(entries):
    """Return a plugin's phase function [sr⁻¹] as a function of an array of cosines μ."""
    import mitsuba as mi

    phase = mi.load_dict(entries, parallel=False)

    def p(mu):
        mu = np.asarray(mu, float)
        it = mi.MediumInteraction3f()
        it.wi = mi.Vector3f(0, 0, -1)  # points to where light came from, so that μ = 1 is along +z
        it.sh_frame = mi.Frame3f(it.wi)
        wo = mi.Vector3f(np.sqrt(1 - mu**2), 0 * mu, mu)
        return np.array(phase.eval_pdf(mi.PhaseFunctionContext(None), it, wo)[1], float)

    return p


def henyey_greenstein(g, mu):
    """Return (1 - g²) / (4π (1 + g² - 2gμ)^(3/2)), a phase function [Lesar 2018, eq. 4.58]."""
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * mu) ** 1.5)


def schlick(k, mu):
    """Return (1 - k²) / (4π (1 - kμ)²), with Henyey-Greenstein's sign [Lesar 2018, eq. 4.59]."""
    return (1 - k * k) / (4 * np.pi * (1 - k * mu) ** 2)


def rayleigh(mu):
    """Return Rayleigh's phase function, 3 (1 + μ²) / 16π [Lesar 2018, eq. 4.61]."""
    return 3 / (16 * np.pi) * (1 + mu * mu)


def compute_moments(p):
    """Return the integral of a phase function over the sphere, and its mean cosine."""
    mu, weight = np.polynomial.legendre.leggauss(POINTS)
    shares = 2 * np.pi * weight * p(mu)
    return shares.sum(), shares @ mu


N = 4001  # values of μ for fits
TARGETS = {  # name: the phase function to fit, and where the fit starts
    "Rayleigh": (rayleigh, (0.5, -0.5, 0.5)),
    "Mie hazy": (lambda mu: phase_functions.even_and_forward_density(8, mu), (0.2, -0.4, 0.7)),
    "Mie murky": (lambda mu: phase_functions.even_and_forward_density(32, mu), (0.3, -0.3, 0.9)),
}


def fit_two_lobes(p, start):
    """Fit a mixture of two of Schlick's lobes to a phase function `p`.

    Returns the weight r and the parameters k₁ and k₂, the relative error, and the largest relative
    one.
    """
    mu = np.linspace(-1, 1, N)
    target = p(mu)

    def compute_residuals(x):
        r, a, b = x
        return r * schlick(a, mu) + (1 - r) * schlick(b, mu) - target

    found = least_squares(
        compute_residuals, start, bounds=([0, -0.999, -0.999], [1, 0.999, 0.999]), xtol=1e-12
    )
    left = compute_residuals(found.x)
    return found.x, np.linalg.norm(left) / np.linalg.norm(target), np.abs(left / target).max()
