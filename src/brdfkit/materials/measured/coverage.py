"""Coverage: the share of all direction pairs that a measurement reaches."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.pair_points import points

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


def coverage(data: Any, max_angle: float = 90.0) -> Coverage:
    """The `Coverage` of a `Measured`, of the pairs with both angles below `max_angle` [degrees]."""
    least = np.cos(np.radians(max_angle))
    if not data.is_table:
        z, phi = np.random.default_rng(0).random((2, 2, PAIRS))
        wi, wo = from_angles(np.arccos(least + (1 - least) * z), 2 * np.pi * phi)
        return coverage_at(data, wi, wo)
    low, high = _cosines(data.samples.wi, data.samples.wo)
    weight = _solid_angles(data.table) * (low > max(least, 0))
    return _share(data, low, high, weight, data.samples.valid)


def coverage_at(data: Any, wi: NDArray[np.float64], wo: NDArray[np.float64]) -> Coverage:
    """The `Coverage` of scattered samples, a `Measured`, at direction pairs (n, 3) alone."""
    low, high = _cosines(wi, wo)
    return _share(data, low, high, np.ones(len(wi)), is_near(data, wi, wo))


def largest_angles(data: Any) -> tuple[float, float]:
    """The largest measured angle of the direction nearer to the normal, and that of the other one
    [degrees]: no pair was measured whose smaller, or larger, angle is above it."""
    valid = data.samples.valid
    low, high = _cosines(data.samples.wi[valid], data.samples.wo[valid])
    smaller, larger = np.degrees(np.arccos(np.minimum([high.min(), low.min()], 1)))
    return float(smaller), float(larger)


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


def _share(data, low, high, weight, reached):
    """The `Coverage` of pairs with these `_cosines` (n,) and weights (n,), of which `reached` (n,)
    were measured."""
    measured = _cosines(*(w[data.samples.valid] for w in (data.samples.wi, data.samples.wo)))
    # neither the larger nor the smaller angle is above the largest such angle that was measured
    within = (low >= measured[0].min()) & (high >= measured[1].min())
    shares = (reached, ~reached & within, ~reached & ~within)
    return Coverage(*(float(weight @ share / weight.sum()) for share in shares))


def _solid_angles(table):
    """The solid angles (cells,) of a table's cells, up to a factor.

    dωi dωo = 4 cos θd dωh dωd [Rusinkiewicz 1998].
    """
    size = table.extents[..., 1:]
    return np.broadcast_to(size, table.shape).reshape(-1)
