"""`choose_directions`: the pairs of directions that tell most about an unknown material.

The pairs are chosen one after the other. Each is the one that most reduces the mean variance of the
logarithms in all cells below 80°, tr(P M), where M is the mean of q qᵀ over the cells:

    gain = qᵀ P M P q / (qᵀ P q + ℓ + σ² + variance by wrong directions).
"""

from math import radians

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.materials.completion.observations import TURNS, Lookup, turn_pairs
from brdfkit.materials.completion.prior import Prior
from brdfkit.materials.completion.prior_cells import get_cells

TARGET_ANGLE = radians(80)  # cells with both angles to the normal below it count
# Directions are chosen for a larger noise than that of the measurement, because no material is
# exactly what a prior says: with 0.1 in place of 0.05, the error of 80 materials was 4 % less
LEAST_NOISE = 0.1


def choose_directions(
    prior: Prior,
    wi: AnyArray,
    wo: AnyArray,
    count: int,
    noise: float = 0.0,
    alignment: float = 0.0,
    measured: tuple[AnyArray, AnyArray] | None = None,
) -> tuple[IntArray, FloatArray]:
    """Choose `count` of the candidate pairs `wi`, `wo` (n, 3), in the order of their gain.

    `noise` is the relative error of a value, `alignment` δ [rad] the angle by which directions are
    off, and `measured` are pairs of directions that are measured already. Returns the rows, and the
    expected error of ln f after each (count + 1,), beginning before the first.
    """
    moments, floor = compute_target_moments(prior)
    covariance: FloatArray = np.eye(prior.rank)
    if measured is not None and len(measured[0]):
        q, variance = describe_pairs(prior, *measured, noise, alignment)
        covariance = np.linalg.inv(covariance + q.T @ (q / variance[:, None]))
    q, variance = describe_pairs(prior, wi, wo, noise, alignment)
    rows: list[int] = []
    errors = [np.sqrt(np.sum(covariance * moments) + floor)]
    for _ in range(count):
        along = q @ covariance
        total = np.sum(along * q, axis=1) + variance
        gain = np.sum((along @ moments) * along, axis=1) / total
        gain[rows] = -1.0
        row = int(np.argmax(gain))
        rows.append(row)
        covariance = covariance - np.outer(along[row], along[row]) / total[row]
        errors.append(np.sqrt(np.sum(covariance * moments) + floor))
    return np.array(rows, int), np.array(errors)


def compute_target_moments(prior: Prior) -> tuple[FloatArray, float]:
    """Return M (rank, rank) over the cells below 80°, and the mean of ℓ there."""
    cells = get_cells()
    target = (cells.theta_i < TARGET_ANGLE) & (cells.theta_o < TARGET_ANGLE)
    q = prior.components[target]
    return q.T @ q / len(q), float(prior.new_remainder[target].mean())


def describe_pairs(
    prior: Prior, wi: AnyArray, wo: AnyArray, noise: float, alignment: float
) -> tuple[FloatArray, FloatArray]:
    """Return q (n, rank) at pairs of directions, and the variance (n,) of what is measured there.

    The variance by wrong directions is its mean over the materials of the prior.
    """
    lookup = Lookup.at(wi, wo)
    q, mean = lookup.interpolate(prior.components), lookup.interpolate(prior.mean)
    variance = lookup.interpolate(prior.new_remainder) + max(noise, LEAST_NOISE) ** 2
    for turned in turn_pairs(wi, wo, alignment):
        shift = turned.interpolate(prior.components) - q
        variance = variance + np.sum(shift**2, axis=1) / TURNS
        variance = variance + (turned.interpolate(prior.mean) - mean) ** 2 / TURNS
    return q, variance
