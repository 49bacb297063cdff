"""Computes which share of all pairs of directions was measured, and how far two pairs differ."""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.evidence import (
    compute_solid_angles,
    find_measured_rows,
    sort_cosines,
)
from brdfkit.materials.measured.measured import Measured
from brdfkit.model.samples import Samples

NEAR_ANGLE = np.radians(5)  # a pair of directions this near to a sample counts as measured
PAIRS = 20_000  # number of random pairs of directions; it makes shares accurate to 0.4 %


@dataclass(frozen=True)
class Coverage:
    """Three shares of all pairs of directions above the surface, by solid angle; their sum is 1.

    `measured`: share in valid cells of a table, in measured ones of a completed table, or within 5°
    of a sample, where reciprocity and the symmetries of an isotropic material count; `between`:
    share that was not measured, at angles to the normal up to the largest measured ones; `beyond`:
    share at larger angles, where values are extrapolated.
    """

    measured: float
    between: float
    beyond: float


def compute_coverage(data: Measured, max_angle: float = 90.0) -> Coverage:
    """Return which shares of all pairs of directions a measurement covers, as a `Coverage`.

    Only pairs with both angles to the normal below `max_angle` [degrees] count.
    """
    least = np.cos(np.radians(max_angle))
    if not data.is_table:
        z, phi = np.random.default_rng(0).random((2, 2, PAIRS))
        wi, wo = from_angles(np.arccos(least + (1 - least) * z), 2 * np.pi * phi)
        return compute_coverage_at(data, wi, wo)
    low, high = sort_cosines(data.samples.wi, data.samples.wo)
    weight = compute_solid_angles(data.table) * (low > max(least, 0))
    return _compute_coverage_shares(data, low, high, weight, find_measured_rows(data))


def compute_coverage_at(data: Measured, wi: FloatArray, wo: FloatArray) -> Coverage:
    """Return how well scattered samples cover given pairs of directions `wi`, `wo` (n, 3)."""
    low, high = sort_cosines(wi, wo)
    return _compute_coverage_shares(data, low, high, np.ones(len(wi)), is_near_sample(data, wi, wo))


def find_largest_angles(data: Measured) -> tuple[float, float]:
    """Return how far from the normal pairs of directions were measured, as two angles [degrees].

    A pair has a smaller and a larger angle to the normal. The results are the maximum over all
    pairs of the smaller angle, and the maximum of the larger angle.
    """
    valid = find_measured_rows(data)
    low, high = sort_cosines(data.samples.wi[valid], data.samples.wo[valid])
    smaller, larger = np.degrees(np.arccos(np.minimum([high.min(), low.min()], 1)))
    return float(smaller), float(larger)


def is_in_plane(samples: Samples) -> bool:
    """Return whether all valid `Samples` lie in the plane of incidence, to within 5°."""
    wi, wo = samples.wi[samples.valid], samples.wo[samples.valid]
    # Compute sin θi sin θo |sin Δφ|, where Δφ is the azimuth between light and view
    across = np.abs(wi[:, 0] * wo[:, 1] - wi[:, 1] * wo[:, 0])
    return bool((across <= np.sin(NEAR_ANGLE) * np.sqrt(1 - wi[:, 2] ** 2)).all())


def is_near_sample(data: Measured, wi: FloatArray, wo: FloatArray) -> BoolArray:
    """Return a mask (n,) of the pairs of directions, (n, 3) each, within 5° of a valid sample.

    Reciprocity counts, and so does the mirror symmetry of an isotropic material.
    """
    from scipy.spatial import cKDTree

    valid = data.samples.at(data.samples.valid)
    both_ways = [
        _map_to_symmetric_points(data, valid.wi, valid.wo),
        _map_to_symmetric_points(data, valid.wo, valid.wi),
    ]
    tree = cKDTree(np.concatenate(both_ways))
    return np.isfinite(
        tree.query(_map_to_symmetric_points(data, wi, wo), distance_upper_bound=NEAR_ANGLE)[0]
    )


def map_pairs_to_points(wi: FloatArray, wo: FloatArray, anisotropic: bool = False) -> FloatArray:
    """Map pairs of directions, (n, 3) each, to points whose distance measures how far pairs differ.

    The points are (n, 4), or (n, 6) for an anisotropic material. Their distance is 1/√2 to 3/2 of
    the angle [rad] between the pairs. On an isotropic material it is the least angle after turning
    one of the pairs about the normal. For pairs with the same θi and θo, but azimuths between wi
    and wo that differ by δ, this is δ sin θi sin θo / √(sin² θi + sin² θo).
    """
    if anisotropic:
        return np.concatenate([wi, wo], axis=-1)
    theta_i, theta_o = (np.arccos(np.clip(w[:, 2], -1, 1)) for w in (wi, wo))
    across_i, across_o = (w[:, 0] + 1j * w[:, 1] for w in (wi, wo))
    length = np.hypot(np.abs(across_i), np.abs(across_o))
    azimuth = across_i * across_o.conj() / np.maximum(length, 1e-12)
    return np.stack([theta_i, theta_o, azimuth.real, azimuth.imag], axis=-1)


def _map_to_symmetric_points(data: Measured, wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Map pairs of directions to points; those that an isotropic material mirrors coincide."""
    points = map_pairs_to_points(wi, wo, data.anisotropic)
    if not data.anisotropic:
        # Drop the sign, which says on which side of the plane of incidence wo lies
        points[:, 3] = np.abs(points[:, 3])
    return points


def _compute_coverage_shares(
    data: Measured, low: FloatArray, high: FloatArray, weight: FloatArray, reached: BoolArray
) -> Coverage:
    """Return the `Coverage` of pairs of directions, given whether each was measured.

    `low` and `high` (n,) are the pairs' cosines to the normal, the smaller and the larger one,
    `weight` (n,) are their solid angles, and the mask `reached` (n,) tells which were measured.
    """
    rows = find_measured_rows(data)
    measured = sort_cosines(*(w[rows] for w in (data.samples.wi, data.samples.wo)))
    # A pair lies within the measured angles if its larger angle to the normal is at most the
    # maximum of the samples' larger angles, and likewise its smaller angle
    within = (low >= measured[0].min()) & (high >= measured[1].min())
    shares = (reached, ~reached & within, ~reached & ~within)
    return Coverage(*(float(weight @ share / weight.sum()) for share in shares))
