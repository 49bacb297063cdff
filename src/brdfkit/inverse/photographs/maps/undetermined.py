"""Finds numbers that the photographs do not determine, and describes them."""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.maps.texel_parameters import TexelParameters

SMALLEST_EIGENVALUE = 1e-4  # below it, a combination of numbers is undetermined
MAIN_PART = 0.3  # relative to the largest entry: such numbers take part in a combination
MENTIONED_SHARE = 0.25  # a number is named if it is undetermined in more of these texels
UNDETERMINED_SHARE = 0.05  # if so many texels are undetermined, a sentence says so


def describe_undetermined(
    parameters: TexelParameters, hessian: FloatArray, lights: int
) -> tuple[str, ...]:
    """Return sentences on the numbers that many texels do not determine by themselves.

    `hessian` (n, count, count) is from the equations of the n texels, without their neighbours.
    """
    sentences = []
    if lights == 1:
        sentences.append(
            "One light: roughness and strength trade off here, and the normal with both."
        )
    hessian = hessian[np.diagonal(hessian, axis1=1, axis2=2).any(axis=1)]  # not at the edge
    columns, scaled = _scale_observed(hessian)
    values, vectors = np.linalg.eigh(scaled)
    undetermined = values[:, 0] < SMALLEST_EIGENVALUE
    if undetermined.mean() < UNDETERMINED_SHARE:
        return tuple(sentences)
    weakest = np.abs(vectors[undetermined, :, 0])
    weakest /= weakest.max(axis=1, keepdims=True)
    shares: dict[str, float] = {}
    for column, share in zip(columns, (weakest > MAIN_PART).mean(axis=0), strict=True):
        name = parameters.number_names[column].partition("[")[0]
        shares[name] = max(share, shares.get(name, 0))
    names = [name for name, share in shares.items() if share > MENTIONED_SHARE] or list(shares)
    apart = f"{join_words(names)} apart" if len(names) > 1 else names[0]
    sentences.append(
        f"In {100 * undetermined.mean():.0f} % of the texels the photographs do not tell {apart}: "
        "there their neighbours decide. More lights near the mirror's direction would."
    )
    return tuple(sentences)


def is_observed(hessian: FloatArray) -> BoolArray:
    """Return which numbers (count,) have any effect; colours without light have none."""
    return np.any(np.diagonal(hessian, axis1=1, axis2=2), axis=0)


def is_undetermined(hessian: FloatArray) -> BoolArray:
    """Return which texels (n,) leave a combination of numbers undetermined."""
    return np.linalg.eigvalsh(_scale_observed(hessian)[1])[:, 0] < SMALLEST_EIGENVALUE


def _scale_observed(hessian: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the indices of the observed numbers, and their Hessians with unit diagonal."""
    columns = np.flatnonzero(is_observed(hessian))
    hessian = hessian[:, columns[:, None], columns]
    scale = 1 / np.sqrt(np.maximum(np.diagonal(hessian, axis1=1, axis2=2), 1e-300))
    return columns, hessian * scale[:, :, None] * scale[:, None, :]
