"""Tabulates any BRDF over half/difference angles."""

import numpy as np

from brdfkit.geometry.directions import from_angles, normalize
from brdfkit.samples import Table

ISOTROPIC = (90, 45, 90)
ANISOTROPIC = (36, 45, 23, 36)
# A cell at the horizon stands for its neighbours, too
LEAST_COSINE = 0.03
ABOUT_NORMAL = np.radians(3)  # one and a half cells
SIDES = np.arange(16) / 16 * 2 * np.pi


def table_shape(anisotropic):
    """Cells of a table, where the data do not ask for others."""
    return ANISOTROPIC if anisotropic else ISOTROPIC


def sampled(brdf, channels, shape, phi_d_period=np.pi):
    """The `Table` of `brdf(wi, wo)` → (n, channels) in `shape` cells, NaN below the surface."""
    table = Table(np.full((*shape, channels), np.nan), phi_d_period)
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    table.values[above] = brdf(wi[above], wo[above])
    return table


def looked_up(lookup, channels, anisotropic):
    """The `Table` of a format's own interpolation, which is as measured: need not be reciprocal."""
    *others, n_phi_d = table_shape(anisotropic)
    brdf = steady(lookup, anisotropic)
    if _is_reciprocal(lookup):
        return sampled(brdf, channels, (*others, n_phi_d))
    return sampled(brdf, channels, (*others, 2 * n_phi_d), 2 * np.pi)


def steady(lookup, anisotropic):
    """A format's own interpolation as a table can hold it: a function (wi, wo) → (n, channels).

    Where it stores f cosθ_o, f has no bound at the horizon: the last 2° have the values before.
    At normal incidence an isotropic material has one value on all sides.
    """

    def off_horizon(wi, wo):
        return lookup(_lifted(wi), _lifted(wo))

    if anisotropic or _is_reciprocal(lookup):
        return off_horizon
    return _same_from_all_sides(off_horizon)


def reciprocal(brdf):
    """`brdf(wi, wo)` with the lower of the two directions as wi, whichever it is.

    What stores f cosθ_o has then been divided by the larger cosine.
    """

    def exchanged(wi, wo):
        lower = wi[:, 2:] < wo[:, 2:]
        return brdf(np.where(lower, wi, wo), np.where(lower, wo, wi))

    return exchanged


def _is_reciprocal(brdf):
    """Whether exchanged directions have the same values, by trial."""
    u, v = np.random.default_rng(0).random((2, 2, 1000))
    wi, wo = from_angles(np.arccos(0.1 + 0.9 * u), 2 * np.pi * v)
    return np.allclose(brdf(wi, wo), brdf(wo, wi), rtol=1e-6)


def _same_from_all_sides(brdf):
    """The BRDF of an isotropic material, whose azimuth ceases to count at normal incidence.

    A file may differ there from side to side, and the cells about the normal hold but one of them.
    """

    def same(wi, wo):
        values = brdf(wi, wo)
        theta_i = np.arccos(np.minimum(wi[:, 2], 1))
        near = theta_i < ABOUT_NORMAL
        theta_h = np.arccos(normalize(wi[near] + wo[near])[:, 2])
        normal = np.broadcast_to([0.0, 0.0, 1.0], (len(theta_h), 3))
        mean = np.mean([brdf(normal, from_angles(2 * theta_h, phi)) for phi in SIDES], axis=0)
        share = np.clip(2 * theta_i[near] / ABOUT_NORMAL - 1, 0, 1)[:, None]
        values[near] = share * values[near] + (1 - share) * mean
        return values

    return same


def _lifted(w):
    """Directions (n, 3), those closer to the horizon than `LEAST_COSINE` moved up to it."""
    z = np.maximum(w[:, 2], LEAST_COSINE)
    shorter = np.sqrt((1 - z * z) / np.maximum(w[:, 0] ** 2 + w[:, 1] ** 2, 1e-12))
    lifted = np.stack([w[:, 0] * shorter, w[:, 1] * shorter, z], axis=1)
    return np.where(w[:, 2:] < LEAST_COSINE, lifted, w)
