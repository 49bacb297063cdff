"""Which part of all direction pairs a measurement reaches."""

from dataclasses import dataclass

import numpy as np

from brdfkit.auditing.pairs import points
from brdfkit.geometry.directions import from_angles

NEAR = np.radians(5)  # a pair this near to a sample counts as measured
PAIRS = 20_000  # the shares are good to 0.4 %


@dataclass(frozen=True)
class Coverage:
    """Shares of the direction pairs above the horizon, evenly in solid angle; their sum is 1.

    `measured`: in valid cells of a table, or within 5° of a sample, the exchange of wi and wo and
    the symmetries of an isotropic material allowed for; `between`: not measured, at angles between
    those that were; `beyond`: at larger ones, where nothing but extrapolation remains.
    """

    measured: float
    between: float
    beyond: float


def coverage(data):
    """The `Coverage` of a `Measured`."""
    samples = data.samples
    low, high = _cosines(samples.wi, samples.wo)
    pairs = _of_table(data, low, high) if data.is_table else _of_samples(data)
    pair_low, pair_high, weight, reached = pairs
    # the larger angle of a pair, and the smaller one, against the largest that were measured
    within = pair_low >= low[samples.valid].min()
    within &= pair_high >= high[samples.valid].min()
    shares = (reached, ~reached & within, ~reached & ~within)
    return Coverage(*(float(weight @ share / weight.sum()) for share in shares))


def is_near(data, wi, wo):
    """Which direction pairs (n, 3) are within 5° of a valid sample."""
    from scipy.spatial import cKDTree

    samples = data.samples
    there = samples.wi[samples.valid], samples.wo[samples.valid]
    both_ways = [_folded(data, *there), _folded(data, *there[::-1])]
    tree = cKDTree(np.concatenate(both_ways))
    return np.isfinite(tree.query(_folded(data, wi, wo), distance_upper_bound=NEAR)[0])


def _folded(data, wi, wo):
    here = points(wi, wo, data.anisotropic)
    if not data.anisotropic:
        here[:, 3] = np.abs(here[:, 3])  # left and right of the plane of incidence
    return here


def _cosines(wi, wo):
    """The cosines of the larger and of the smaller angle of pairs."""
    return np.minimum(wi[:, 2], wo[:, 2]), np.maximum(wi[:, 2], wo[:, 2])


def _of_samples(data):
    """Random pairs, evenly in solid angle: cosines, weights, and which of them are measured."""
    z, phi = np.random.default_rng(0).random((2, 2, PAIRS))
    wi, wo = from_angles(np.arccos(z), 2 * np.pi * phi)
    return *_cosines(wi, wo), np.ones(PAIRS), is_near(data, wi, wo)


def _of_table(data, low, high):
    """Likewise the cells, their weights the solid angles of those above the horizon.

    dωi dωo = 4 cos θd dωh dωd [Rusinkiewicz 1998].
    """
    table = data.table
    theta_h, theta_d, _ = np.meshgrid(*table.centres[-3:], indexing="ij", sparse=True)
    size = table.theta_h_widths * np.sin(theta_h) * np.sin(theta_d) * np.cos(theta_d)
    weight = np.broadcast_to(size, table.shape).reshape(-1) * (low > 0)
    return low, high, weight, data.samples.valid
