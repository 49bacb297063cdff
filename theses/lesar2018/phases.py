"""Phase functions as numbers: their values over the cosine of the angle of deflection."""

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
POINTS = 200  # of a quadrature


def of_plugin(entries):
    """p(μ) [sr⁻¹] of a plugin, a function of an array (n,)."""
    import mitsuba as mi

    phase = mi.load_dict(entries, parallel=False)

    def p(mu):
        mu = np.asarray(mu, float)
        it = mi.MediumInteraction3f()
        it.wi = mi.Vector3f(0, 0, -1)  # back, to where light came from: μ = 1 goes on along z
        it.sh_frame = mi.Frame3f(it.wi)
        wo = mi.Vector3f(np.sqrt(1 - mu**2), 0 * mu, mu)
        return np.array(phase.eval_pdf(mi.PhaseFunctionContext(None), it, wo)[1], float)

    return p


def henyey_greenstein(g, mu):
    """(1 - g²) / (4π (1 + g² - 2gμ)^(3/2)) [Lesar 2018, eq. 4.58]."""
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * mu) ** 1.5)


def schlick(k, mu):
    """(1 - k²) / (4π (1 - kμ)²): with the sign of Henyey-Greenstein's [Lesar 2018, eq. 4.59]."""
    return (1 - k * k) / (4 * np.pi * (1 - k * mu) ** 2)


def rayleigh(mu):
    """3 (1 + μ²) / 16π [Lesar 2018, eq. 4.61]."""
    return 3 / (16 * np.pi) * (1 + mu * mu)


def moments(p):
    """∫ p over the sphere, and the mean cosine, by quadrature."""
    mu, weight = np.polynomial.legendre.leggauss(POINTS)
    shares = 2 * np.pi * weight * p(mu)
    return shares.sum(), shares @ mu


N = 4001  # of μ
TARGETS = {  # name: p(μ), and a start of the fit
    "Rayleigh": (rayleigh, (0.5, -0.5, 0.5)),
    "Mie hazy": (lambda mu: phase_functions.even_and_forward_density(8, mu), (0.2, -0.4, 0.7)),
    "Mie murky": (lambda mu: phase_functions.even_and_forward_density(32, mu), (0.3, -0.3, 0.9)),
}


def fit(p, start):
    """(r, k₁, k₂) of two of Schlick's lobes, the relative error, and the largest relative one."""
    mu = np.linspace(-1, 1, N)
    target = p(mu)

    def off(x):
        r, a, b = x
        return r * schlick(a, mu) + (1 - r) * schlick(b, mu) - target

    found = least_squares(off, start, bounds=([0, -0.999, -0.999], [1, 0.999, 0.999]), xtol=1e-12)
    left = off(found.x)
    return found.x, np.linalg.norm(left) / np.linalg.norm(target), np.abs(left / target).max()
