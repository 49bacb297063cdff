"""Tabulates any BRDF over half/difference angles, a `Table`."""

import numpy as np

from brdfkit.core.geometry.directions import from_angles, normalize
from brdfkit.model.samples import Table

# Cells ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d)
ISOTROPIC = (90, 45, 90)
ANISOTROPIC = (36, 45, 23, 36)
LEAST_COSINE = 0.03  # about 2° above the horizon
NEAR_NORMAL = np.radians(3)  # one and a half cells of theta_d
AZIMUTHS = np.arange(16) / 16 * 2 * np.pi


def table_shape(anisotropic):
    """The default shape of a table."""
    return ANISOTROPIC if anisotropic else ISOTROPIC


def tabulate(brdf, channels, shape, phi_d_period=np.pi):
    """The `Table` of `brdf(wi, wo)` → (n, channels) at the centres of `shape` cells.

    A cell whose centre lies below the surface is NaN.
    """
    table = Table(np.full((*shape, channels), np.nan), phi_d_period)
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    table.values[above] = brdf(wi[above], wo[above])
    return table


def tabulate_lookup(lookup, channels, anisotropic):
    """The `Table` of a format's own interpolation, with all of phi_d unless it is reciprocal."""
    *others, n_phi_d = table_shape(anisotropic)
    brdf = bounded(lookup, anisotropic)
    if _is_reciprocal(lookup):
        return tabulate(brdf, channels, (*others, n_phi_d))
    return tabulate(brdf, channels, (*others, 2 * n_phi_d), 2 * np.pi)


def bounded(lookup, anisotropic):
    """A format's own interpolation, bounded for a table: a function (wi, wo) → (n, channels).

    Directions are clamped 2° above the horizon: where the format stores f cosθ_o, f grows without
    bound towards it. At normal incidence an isotropic lookup that is not reciprocal is averaged
    over the azimuth.
    """

    def clamped(wi, wo):
        return lookup(_lift(wi), _lift(wo))

    if anisotropic or _is_reciprocal(lookup):
        return clamped
    return _average_at_normal(clamped)


def reciprocal(brdf):
    """`brdf` made reciprocal: a function that calls it with the more grazing direction as wi.

    Where a format stores f cosθ_o, its values are thus divided by the larger cosine.
    """

    def call_with_lower_first(wi, wo):
        lower = wi[:, 2:] < wo[:, 2:]
        return brdf(np.where(lower, wi, wo), np.where(lower, wo, wi))

    return call_with_lower_first


def _is_reciprocal(brdf):
    """Whether exchanging the directions of 1,000 random pairs leaves the values equal."""
    u, v = np.random.default_rng(0).random((2, 2, 1000))
    wi, wo = from_angles(np.arccos(0.1 + 0.9 * u), 2 * np.pi * v)
    return np.allclose(brdf(wi, wo), brdf(wo, wi), rtol=1e-6)


def _average_at_normal(brdf):
    """The BRDF of an isotropic material, averaged over the azimuth of wo at normal incidence.

    There the azimuth means nothing, but a file's values may depend on it; a table cell near the
    normal would hold the value at one azimuth only. Up to 3° the mean fades out.
    """

    def average(wi, wo):
        values = brdf(wi, wo)
        theta_i = np.arccos(np.minimum(wi[:, 2], 1))
        near = theta_i < NEAR_NORMAL
        # The mean over wo at the same theta_h, with wi at the normal
        theta_h = np.arccos(normalize(wi[near] + wo[near])[:, 2])
        normal = np.broadcast_to([0.0, 0.0, 1.0], (len(theta_h), 3))
        mean = np.mean([brdf(normal, from_angles(2 * theta_h, phi)) for phi in AZIMUTHS], axis=0)
        # Only the mean up to half of `NEAR_NORMAL`, then a linear transition
        share = np.clip(2 * theta_i[near] / NEAR_NORMAL - 1, 0, 1)[:, None]
        values[near] = share * values[near] + (1 - share) * mean
        return values

    return average


def _lift(w):
    """The directions `w` (n, 3), with those whose cosine is below `LEAST_COSINE` lifted to it."""
    z = np.maximum(w[:, 2], LEAST_COSINE)
    shorter = np.sqrt((1 - z * z) / np.maximum(w[:, 0] ** 2 + w[:, 1] ** 2, 1e-12))
    lifted = np.stack([w[:, 0] * shorter, w[:, 1] * shorter, z], axis=1)
    return np.where(w[:, 2:] < LEAST_COSINE, lifted, w)
