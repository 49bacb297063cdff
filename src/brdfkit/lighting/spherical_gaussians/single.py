"""One lobe per view, and n sharper ones in its place: the thesis's `warped` and `kde`.

The thesis warps the lobe of a roughness that the model has (`warp`). Here a lobe is fitted to what
the view sees, so that any material has one. Beside it is a cosine, by the same steps as those of a
mixture: light that is far from the lobe joins the diffuse part and does not widen the lobe.
"""

import numpy as np

from brdfkit.lighting.spherical_gaussians import kernel_density
from brdfkit.lighting.spherical_gaussians import von_mises_fisher as vmf

STEPS = 50


def warped(grid, lobes):
    """(diffuse, weights (1, channels), axes, κ) of each `OneView` of a `grid`; `lobes` is 1."""
    return [[_one_lobe(one) for one in views] for views in grid]


def kde(grid, lobes):
    """The same lobe, split into as many sharper `lobes` of equal weight."""
    return [[_split(*_one_lobe(one), lobes) for one in views] for views in grid]


def _one_lobe(one):
    """The likeliest lobe beside a cosine; begins as narrow as the highest value allows."""
    x, weights = one.samples()
    light = one.energy.sum(axis=0)
    brightest = one.rest.mean(axis=1).argmax()
    axis = one.directions[brightest]
    kappa = 2 * np.pi * one.rest[brightest].mean() / max(light.mean(), 1e-9)
    part = 0.9  # of the light: what is the lobe's
    for _ in range(STEPS):
        lobe = part * np.exp(vmf.log_density(x @ axis, kappa))
        weight = weights * lobe / (lobe + (1 - part) * x[:, 2] / np.pi)
        part = weight.sum() / weights.sum()
        mean = weight @ x / weight.sum()
        axis, kappa = mean / np.linalg.norm(mean), vmf.kappa_of(np.linalg.norm(mean))
    return one.diffuse + (1 - part) * light, part * light[None], axis[None], kappa[None]


def _split(diffuse, weights, axes, kappa, n):
    axes, kappa = kernel_density.split(axes[0], kappa[0], n)
    return diffuse, np.repeat(weights / n, n, axis=0), axes, np.full(n, kappa)
