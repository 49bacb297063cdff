"""One lobe as n sharper lobes of equal weight: a kernel density estimate on the sphere.

The thesis takes n points of the lobe and the kernel of García-Portugués's rule of thumb. A kernel
blurs what it estimates: the κ of the sum is only about κ / (1 + n^(-1/3)). Here points and kernel
are those of a sharper lobe, whose estimate has the width of the lobe wanted.

[Ergun 2015, section 8.6]; [García-Portugués 2013]
"""

import numpy as np

from brdfkit.lighting.spherical_gaussians import von_mises_fisher as vmf


def bandwidth(kappa, n):
    """h of n samples of a lobe, for kernels of κ = 1 / h².

    >>> round(float(bandwidth(50.0, 8)), 6)
    0.100166
    """
    k = np.asarray(kappa, float)
    # Numerator and denominator times e^(-2κ)
    sinh_squared = (np.expm1(-2 * k) / 2) ** 2
    sinh_twice, cosh_twice = -np.expm1(-4 * k) / 2, (1 + np.exp(-4 * k)) / 2
    spread = (1 + 4 * k**2) * sinh_twice - 2 * k * cosh_twice
    return (8 * sinh_squared / (k * n * spread)) ** (1 / 6)


def split(mu, kappa, n):
    """Axes (..., n, 3) and the κ (...) of n lobes that together are as wide as the lobe μ, κ."""
    sharper = _sharper(np.maximum(kappa, 0.1), n)
    return vmf.points(mu, sharper, n), bandwidth(sharper, n) ** -2


def width(kappa, n):
    """The concentration of the estimate of a lobe by n of its points: that of its mean."""
    kappa = np.asarray(kappa, float)
    mean = vmf.points(np.array([0.0, 0.0, 1.0]), kappa, n).mean(axis=-2)
    # The mean of a convolution is the product of the two
    length = np.linalg.norm(mean, axis=-1) * vmf.mean_cosine(bandwidth(kappa, n) ** -2)
    return vmf.kappa_of(length)


def _sharper(kappa, n):
    """The concentration whose estimate has the `width` κ."""
    found = kappa * (1 + n ** (-1 / 3))
    for _ in range(10):  # the width is nearly in proportion to it
        found = found * kappa / width(found, n)
    return found
