"""The share of all direction pairs that a measurement reaches, and distances between such pairs."""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.measured import Measured
from brdfkit.model.samples import Samples, Table

NEAR_ANGLE = np.radians(5)  # a pair this near to a sample counts as measured
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


def compute_coverage(data: Measured, max_angle: float = 90.0) -> Coverage:
    """Return the `Coverage` of the direction pairs with both angles below `max_angle` [degrees]."""
    least = np.cos(np.radians(max_angle))
    if not data.is_table:
        z, phi = np.random.default_rng(0).random((2, 2, PAIRS))
        wi, wo = from_angles(np.arccos(least + (1 - least) * z), 2 * np.pi * phi)
        return compute_coverage_at(data, wi, wo)
    low, high = _sort_cosines(data.samples.wi, data.samples.wo)
    weight = _compute_solid_angles(data.table) * (low > max(least, 0))
    return _share(data, low, high, weight, data.samples.valid)


def compute_coverage_at(data: Measured, wi: FloatArray, wo: FloatArray) -> Coverage:
    """Return the `Coverage` by scattered samples of these direction pairs (n, 3) alone."""
    low, high = _sort_cosines(wi, wo)
    return _share(data, low, high, np.ones(len(wi)), is_near(data, wi, wo))


def find_largest_angles(data: Measured) -> tuple[float, float]:
    """Return the largest measured angles [degrees] of the nearer and of the farther direction.

    Of each pair, the nearer direction has the smaller angle to the normal. No measured pair has a
    smaller angle above the first result, or a larger angle above the second.
    """
    valid = data.samples.valid
    low, high = _sort_cosines(data.samples.wi[valid], data.samples.wo[valid])
    smaller, larger = np.degrees(np.arccos(np.minimum([high.min(), low.min()], 1)))
    return float(smaller), float(larger)


def is_in_plane(samples: Samples) -> bool:
    """Return whether all valid `Samples` are in the plane of incidence, within 5°."""
    wi, wo = samples.wi[samples.valid], samples.wo[samples.valid]
    across = np.abs(wi[:, 0] * wo[:, 1] - wi[:, 1] * wo[:, 0])  # sin θi sin θo |sin Δφ|
    return bool((across <= np.sin(NEAR_ANGLE) * np.sqrt(1 - wi[:, 2] ** 2)).all())


def is_near(data: Measured, wi: FloatArray, wo: FloatArray) -> BoolArray:
    """Return a mask (n,) of the direction pairs (n, 3) that are within 5° of a valid sample."""
    from scipy.spatial import cKDTree

    valid = data.samples.at(data.samples.valid)
    both_ways = [_fold(data, valid.wi, valid.wo), _fold(data, valid.wo, valid.wi)]
    tree = cKDTree(np.concatenate(both_ways))
    return np.isfinite(tree.query(_fold(data, wi, wo), distance_upper_bound=NEAR_ANGLE)[0])


def to_points(wi: FloatArray, wo: FloatArray, anisotropic: bool = False) -> FloatArray:
    """Return direction pairs (n, 3) as points whose distance says how far the directions differ.

    The points are (n, 4), or (n, 6) for an anisotropic material. Their distance is 1/√2 to 3/2 of
    the angle [rad] by which the pairs' directions differ. For an isotropic material only the
    azimuth between wi and wo counts: where it differs by δ between two pairs, no common rotation
    brings the pairs nearer to each other than δ sin θi sin θo / √(sin² θi + sin² θo).
    """
    if anisotropic:
        return np.concatenate([wi, wo], axis=-1)
    theta_i, theta_o = (np.arccos(np.clip(w[:, 2], -1, 1)) for w in (wi, wo))
    across_i, across_o = (w[:, 0] + 1j * w[:, 1] for w in (wi, wo))
    length = np.hypot(np.abs(across_i), np.abs(across_o))
    azimuth = across_i * across_o.conj() / np.maximum(length, 1e-12)
    return np.stack([theta_i, theta_o, azimuth.real, azimuth.imag], axis=-1)


def _fold(data: Measured, wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Return direction pairs as points; mirror images on an isotropic material are one point."""
    points = to_points(wi, wo, data.anisotropic)
    if not data.anisotropic:
        points[:, 3] = np.abs(points[:, 3])  # left and right of the plane of incidence
    return points


def _sort_cosines(wi: FloatArray, wo: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the smaller and the larger cosine to the normal of each pair, both (n,)."""
    return np.minimum(wi[:, 2], wo[:, 2]), np.maximum(wi[:, 2], wo[:, 2])


def _share(
    data: Measured, low: FloatArray, high: FloatArray, weight: FloatArray, reached: BoolArray
) -> Coverage:
    """Return the `Coverage` of pairs with the cosines `low` and `high` and with these weights (n,).

    `reached` (n,) is True where a pair was measured.
    """
    measured = _sort_cosines(*(w[data.samples.valid] for w in (data.samples.wi, data.samples.wo)))
    # Neither the larger nor the smaller angle is above the largest such angle that was measured
    within = (low >= measured[0].min()) & (high >= measured[1].min())
    shares = (reached, ~reached & within, ~reached & ~within)
    return Coverage(*(float(weight @ share / weight.sum()) for share in shares))


def _compute_solid_angles(table: Table) -> FloatArray:
    """Return the solid angles (cells,) of a table's cells, up to a factor.

    dωi dωo = 4 cos θd dωh dωd [Rusinkiewicz 1998].
    """
    size = table.extents[..., 1:]
    return np.broadcast_to(size, table.shape).reshape(-1)
