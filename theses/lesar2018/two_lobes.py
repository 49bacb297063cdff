"""Two of Schlick's lobes in the place of other phase functions, by least squares."""

import numpy as np
from brdfkit.theses.lesar2018.phases import rayleigh, schlick
from scipy.optimize import least_squares

from brdfkit.mitsuba_bridge import even_and_forward

N = 4001  # of μ
TARGETS = {  # name: p(μ), and a start of the fit
    "Rayleigh": (rayleigh, (0.5, -0.5, 0.5)),
    "Mie hazy": (lambda mu: even_and_forward.density(8, mu), (0.2, -0.4, 0.7)),
    "Mie murky": (lambda mu: even_and_forward.density(32, mu), (0.3, -0.3, 0.9)),
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
