"""Coverage: the share of all direction pairs that a measurement reaches."""

from dataclasses import dataclass

import numpy as np

from brdfkit.auditing.symmetries import points
from brdfkit.geometry.directions import from_angles

NEAR = np.radians(5)  # a pair this near to a sample counts as measured
PAIRS = 20_000  # random pairs for scattered samples: the shares are accurate to 0.4 %


@dataclass(frozen=True)
class Coverage:
    """Shares of the direction pairs above the horizon, by solid angle; their sum is 1.

    `measured`: in valid cells of a table, or within 5° of a sample, also after exchanging wi and wo
    and by the symmetries of an isotropic material; `between`: not measured, at angles up to the
    largest measured ones; `beyond`: at larger angles, where values are extrapolated.
    """

    measured: float
    between: float
    beyond: float


def coverage(data):
    """The `Coverage` of a `Measured`."""
    samples = data.samples
    low, high = _cosines(samples.wi, samples.wo)
    pairs = _table_pairs(data, low, high) if data.is_table else _random_pairs(data)
    pair_low, pair_high, weight, reached = pairs
    # neither the larger nor the smaller angle is above the largest such angle that was measured
    within = pair_low >= low[samples.valid].min()
    within &= pair_high >= high[samples.valid].min()
    shares = (reached, ~reached & within, ~reached & ~within)
    return Coverage(*(float(weight @ share / weight.sum()) for share in shares))


def in_plane(samples):
    """Whether all valid `Samples` are in the plane of incidence, within 5°."""
    wi, wo = samples.wi[samples.valid], samples.wo[samples.valid]
    across = np.abs(wi[:, 0] * wo[:, 1] - wi[:, 1] * wo[:, 0])  # sin θi sin θo |sin Δφ|
    return bool((across <= np.sin(NEAR) * np.sqrt(1 - wi[:, 2] ** 2)).all())


def is_near(data, wi, wo):
    """Which direction pairs are within 5° of a valid sample: a mask (n,) for `wi`, `wo` (n, 3)."""
    from scipy.spatial import cKDTree

    samples = data.samples
    there = samples.wi[samples.valid], samples.wo[samples.valid]
    both_ways = [_fold(data, *there), _fold(data, *there[::-1])]
    tree = cKDTree(np.concatenate(both_ways))
    return np.isfinite(tree.query(_fold(data, wi, wo), distance_upper_bound=NEAR)[0])


def _fold(data, wi, wo):
    """The pairs as `points`; of an isotropic material, mirror images are the same point."""
    here = points(wi, wo, data.anisotropic)
    if not data.anisotropic:
        here[:, 3] = np.abs(here[:, 3])  # left and right of the plane of incidence
    return here


def _cosines(wi, wo):
    """The cosine of the larger angle, and that of the smaller angle, of each pair; both (n,)."""
    return np.minimum(wi[:, 2], wo[:, 2]), np.maximum(wi[:, 2], wo[:, 2])


def _random_pairs(data):
    """Random pairs, uniform in solid angle: their `_cosines`, weights, and which are measured."""
    z, phi = np.random.default_rng(0).random((2, 2, PAIRS))
    wi, wo = from_angles(np.arccos(z), 2 * np.pi * phi)
    return *_cosines(wi, wo), np.ones(PAIRS), is_near(data, wi, wo)


def _table_pairs(data, low, high):
    """The same of a table's cells; their weights are their solid angles above the horizon.

    dωi dωo = 4 cos θd dωh dωd [Rusinkiewicz 1998].
    """
    table = data.table
    theta_h, theta_d, _ = np.meshgrid(*table.centres[-3:], indexing="ij", sparse=True)
    size = table.theta_h_widths * np.sin(theta_h) * np.sin(theta_d) * np.cos(theta_d)
    weight = np.broadcast_to(size, table.shape).reshape(-1) * (low > 0)
    return low, high, weight, data.samples.valid
