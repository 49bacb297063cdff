"""Tabulates any BRDF over half and difference angles, as a `Table`."""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles, normalize
from brdfkit.materials.measured.measured_data import Lookup
from brdfkit.model.samples import Table

# Default numbers of cells of a table ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d)
ISOTROPIC = (90, 45, 90)
ANISOTROPIC = (36, 45, 23, 36)
# Directions with a smaller cosine to the normal are lifted to this one, about 2° above the horizon
LEAST_COSINE = 0.03
# Values for light within this angle [rad] of the normal, one and a half cells of theta_d, are
# averaged over AZIMUTHS
NEAR_NORMAL = np.radians(3)
AZIMUTHS = np.arange(16) / 16 * 2 * np.pi


def choose_table_shape(anisotropic: bool) -> tuple[int, ...]:
    """Return the default numbers of cells ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d) of a table."""
    return ANISOTROPIC if anisotropic else ISOTROPIC


def tabulate(
    brdf: Lookup, channels: int, shape: tuple[int, ...], phi_d_period: float = np.pi
) -> Table:
    """Evaluate a BRDF with this number of `channels` at the centres of a table's cells.

    The `Table` has `shape` cells. Those whose centre has a direction below the surface are NaN.
    """
    table = Table(np.full((*shape, channels), np.nan), phi_d_period)
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    table.values[above] = brdf(wi[above], wo[above])
    return table


def tabulate_lookup(lookup: Lookup, channels: int, anisotropic: bool) -> Table:
    """Tabulate the BRDF that a file format's own interpolation function `lookup` returns.

    The table's phi_d runs over π, or over 2π where the BRDF is not reciprocal.
    """
    *others, n_phi_d = choose_table_shape(anisotropic)
    brdf = limit_lookup_values(lookup, anisotropic)
    if _is_reciprocal(lookup):
        return tabulate(brdf, channels, (*others, n_phi_d))
    return tabulate(brdf, channels, (*others, 2 * n_phi_d), 2 * np.pi)


def limit_lookup_values(lookup: Lookup, anisotropic: bool) -> Lookup:
    """Return the interpolation function of a file format, modified so that a table can hold it.

    Directions are lifted to 2° above the horizon, because the BRDF of a format that stores
    f cosθ_o may grow without bound towards the horizon. An isotropic lookup that is not reciprocal
    is averaged over the azimuth at normal incidence.
    """

    def look_up_clamped(wi: FloatArray, wo: FloatArray) -> FloatArray:
        return lookup(_lift_above_horizon(wi), _lift_above_horizon(wo))

    if anisotropic or _is_reciprocal(lookup):
        return look_up_clamped
    return _average_at_normal(look_up_clamped)


def make_reciprocal(brdf: Lookup) -> Lookup:
    """Return a reciprocal BRDF, which calls `brdf` with the direction nearer to the horizon as wi.

    A format that stores the BRDF times cosθ_o then divides by the larger of the two cosines, which
    amplifies errors less.
    """

    def call_with_lower_first(wi: FloatArray, wo: FloatArray) -> FloatArray:
        lower = wi[:, 2:] < wo[:, 2:]
        return brdf(np.where(lower, wi, wo), np.where(lower, wo, wi))

    return call_with_lower_first


def _is_reciprocal(brdf: Lookup) -> bool:
    """Return whether a BRDF is reciprocal, by exchanging the directions of 1,000 random pairs."""
    u, v = np.random.default_rng(0).random((2, 2, 1000))
    wi, wo = from_angles(np.arccos(0.1 + 0.9 * u), 2 * np.pi * v)
    return np.allclose(brdf(wi, wo), brdf(wo, wi), rtol=1e-6)


def _average_at_normal(brdf: Lookup) -> Lookup:
    """Return an isotropic BRDF whose values near normal incidence are averaged over the azimuth.

    At normal incidence the azimuth of wo has no meaning, but a file's values may depend on it, and
    a table's cell would take the value at one azimuth. The mean is faded out until wi is 3° from
    the normal.
    """

    def average_near_normal(wi: FloatArray, wo: FloatArray) -> FloatArray:
        values = brdf(wi, wo)
        theta_i = np.arccos(np.minimum(wi[:, 2], 1))
        near = theta_i < NEAR_NORMAL
        # Average over the azimuth of wo, with wi along the normal and the same half angle theta_h
        theta_h = np.arccos(normalize(wi[near] + wo[near])[:, 2])
        normal = np.broadcast_to([0.0, 0.0, 1.0], (len(theta_h), 3))
        mean = np.mean([brdf(normal, from_angles(2 * theta_h, phi)) for phi in AZIMUTHS], axis=0)
        # Up to half of `NEAR_NORMAL` take the mean alone, then fade linearly to the values
        share = np.clip(2 * theta_i[near] / NEAR_NORMAL - 1, 0, 1)[:, None]
        values[near] = share * values[near] + (1 - share) * mean
        return values

    return average_near_normal


def _lift_above_horizon(w: FloatArray) -> FloatArray:
    """Return the directions `w` (n, 3), lifted to the cosine `LEAST_COSINE` where it is smaller."""
    z = np.maximum(w[:, 2], LEAST_COSINE)
    shorter = np.sqrt((1 - z * z) / np.maximum(w[:, 0] ** 2 + w[:, 1] ** 2, 1e-12))
    lifted = np.stack([w[:, 0] * shorter, w[:, 1] * shorter, z], axis=1)
    return np.where(w[:, 2:] < LEAST_COSINE, lifted, w)
