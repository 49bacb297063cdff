"""Finds parameters of texels that the photographs do not determine, and tells the user of them."""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.maps.texel_parameters import TexelParameters

# If an eigenvalue of a texel's Hessian, scaled to a unit diagonal, is smaller than this, the
# photographs do not determine the combination of numbers in its eigenvector
SMALLEST_EIGENVALUE = 1e-4
# A number is part of a combination if its entry of the eigenvector is larger than this share of the
# largest entry
MAIN_PART = 0.3
# A number is named in the notes if it is undetermined in more than this share of the texels that
# have undetermined numbers
MENTIONED_SHARE = 0.25
# Share of texels with undetermined numbers above which the notes mention them
UNDETERMINED_SHARE = 0.05


def describe_undetermined(
    parameters: TexelParameters, hessian: FloatArray, lights: int
) -> tuple[str, ...]:
    """Return sentences on parameters that the photographs do not determine in many texels.

    `hessian` (texels, numbers, numbers) holds the second derivatives of each texel's own squared
    residuals, without the penalty on differences from its neighbours. `lights` is the number of
    lights.
    """
    sentences = []
    if lights == 1:
        sentences.append(
            "One light: roughness and strength trade off here, and the normal with both."
        )
    # Texels at the edge, which have no observations and a Hessian of 0, are left out
    hessian = hessian[np.diagonal(hessian, axis1=1, axis2=2).any(axis=1)]
    columns, scaled = _scale_observed_hessians(hessian)
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
    """Return which searched numbers affect the photographs; colours without light do not.

    `hessian` (texels, numbers, numbers) holds the second derivatives of the squared residuals.
    """
    return np.any(np.diagonal(hessian, axis1=1, axis2=2), axis=0)


def is_undetermined(hessian: FloatArray) -> BoolArray:
    """Return in which texels (n,) the photographs leave some combination of numbers undetermined.

    `hessian` (n, numbers, numbers) holds the second derivatives of the squared residuals.
    """
    return np.linalg.eigvalsh(_scale_observed_hessians(hessian)[1])[:, 0] < SMALLEST_EIGENVALUE


def _scale_observed_hessians(hessian: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the indices of the numbers that affect photographs, and their scaled Hessians.

    The Hessian of each texel is scaled to have a unit diagonal.
    """
    columns = np.flatnonzero(is_observed(hessian))
    hessian = hessian[:, columns[:, None], columns]
    scale = 1 / np.sqrt(np.maximum(np.diagonal(hessian, axis1=1, axis2=2), 1e-300))
    return columns, hessian * scale[:, :, None] * scale[:, None, :]
