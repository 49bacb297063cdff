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
    return [[_split(one, 1) for one in views] for views in grid]


def kde(grid, lobes):
    """The same lobe, split into as many sharper `lobes` of equal weight."""
    return [[_split(one, lobes) for one in views] for views in grid]


def _split(one, n):
    """The one lobe of a view, or n in its place, and the diffuse part with all other light."""
    part, _, axis, kappa = one_lobe(one)
    light = one.energy.sum(axis=0)
    axes, kappa = kernel_density.split(axis, kappa, n) if n > 1 else (axis[None], kappa)
    weights = np.repeat(part * light[None] / n, n, axis=0)
    return one.diffuse + (1 - part) * light, weights, axes, np.full(n, kappa)


def one_lobe(one):
    """The likeliest lobe beside a cosine; begins as narrow as the highest value allows.

    Returns its part of the light, its share (m,) of each of `one.samples()`, its axis and κ.
    """
    x, weights = one.samples()
    brightest = one.rest.mean(axis=1).argmax()
    axis = one.directions[brightest]
    kappa = 2 * np.pi * one.rest[brightest].mean() / max(one.energy.sum(axis=0).mean(), 1e-9)
    part = 0.9
    for _ in range(STEPS):
        lobe = part * np.exp(vmf.log_density(x @ axis, kappa))
        share = lobe / (lobe + (1 - part) * x[:, 2] / np.pi)
        part = weights @ share / weights.sum()
        mean = (weights * share) @ x / (weights @ share)
        axis, kappa = mean / np.linalg.norm(mean), vmf.kappa_of(np.linalg.norm(mean))
    return part, share, axis, kappa
