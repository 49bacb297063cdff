"""Finds lights whose axes are not those of the photographs, by the normals that they lead to.

Lambert's law fits photographs equally well if the lights and the normals are mirrored. But at the
outline of an object its normals point outwards, and they are those of a surface: with the slopes
p = -n_x / n_z and q = -n_y / n_z, ∂p/∂y = ∂q/∂x.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from scipy import ndimage

from brdfkit.core.array_types import BoolArray, FloatArray

# What the best axes show if the evidence against the given ones is overwhelming: at the outline
# the mean cosine between normals and the outward direction is above CLEAR, and above that of the
# given axes by GAIN, and it is above SURE, or the curl is not larger; or the given normals are
# those of no surface, in comparison by LESS_CURL
CLEAR, GAIN, SURE, LESS_CURL = 0.5, 0.6, 0.8, 0.7
OUTLINE_WIDTH = 2  # pixels
SMOOTHING = 2.0  # pixels, of the mask whose gradient points outwards
SMALLEST_TILT = 0.1  # sine of the angle between a normal at the outline and the camera
SMALLEST_N_Z = 0.2


def find_axes(scaled_normals: FloatArray, mask: BoolArray) -> FloatArray | None:
    """Return the matrix (3, 3) that turns lights into the axes of the photographs.

    None if the axes are right, or if it is not sure that others are. `scaled_normals` (n, 3) are
    normals of any length by the lights as given; `mask` (height, width) has n pixels.
    """
    scores = [(*score_axes(turn, scaled_normals, mask), turn) for turn in list_turns()]
    outward, curl, _ = scores[0]  # the first turn is none
    best = max(scores, key=lambda score: score[0] - score[1])
    better = best[0] > CLEAR and best[0] - outward > GAIN
    better &= best[0] > SURE or best[1] < 1.1 * curl
    straighter = best[0] > max(CLEAR, outward) and best[1] < LESS_CURL * curl
    if best is scores[0] or not (better or straighter):
        return None
    matrix = np.eye(3)
    matrix[:2, :2] = best[2]
    return matrix


def list_turns() -> Iterator[FloatArray]:
    """Yield the eight matrices (2, 2) that mirror or turn a picture, first the unit matrix."""
    for is_swapped, x, y in product((False, True), (1.0, -1.0), (1.0, -1.0)):
        matrix = np.diag([x, y])
        yield matrix[:, ::-1] if is_swapped else matrix


def score_axes(
    turn: FloatArray, scaled_normals: FloatArray, mask: BoolArray
) -> tuple[float, float]:
    """Return how far normals, turned by a matrix (2, 2), point outwards at the outline, and curl.

    The first result is a mean cosine; 0 without an outline. The second one is 0 for normals of a
    smooth surface, and about 1 for random ones.
    """
    unit = scaled_normals / np.maximum(np.linalg.norm(scaled_normals, axis=1), 1e-300)[:, None]
    normals = np.full((*mask.shape, 3), np.nan)
    normals[mask] = np.column_stack([unit[:, :2] @ turn.T, unit[:, 2]])
    return _measure_outwardness(normals, mask), _measure_curl(normals, mask)


def _measure_outwardness(normals: FloatArray, mask: BoolArray) -> float:
    """Return the mean cosine between the outward direction and normals at the outline of a mask."""
    edge, outward = find_outline(mask)
    sideways = np.linalg.norm(normals[edge, :2], axis=1)
    tilted = sideways > SMALLEST_TILT
    if not tilted.any():
        return 0.0
    cosine = (normals[edge, :2] * outward).sum(axis=1)[tilted] / sideways[tilted]
    return float(cosine.mean())


def find_outline(mask: BoolArray) -> tuple[BoolArray, FloatArray]:
    """Return the pixels at the outline of a mask (height, width), and outward directions there.

    The directions (m, 2) are unit vectors, x to the right and y up. The edge of the photograph is
    no outline of the object.
    """
    down, right = np.gradient(ndimage.gaussian_filter(mask.astype(float), SMOOTHING))
    outward = np.stack([-right, down], axis=-1)
    length = np.linalg.norm(outward, axis=-1)
    inside = ndimage.binary_erosion(mask, iterations=OUTLINE_WIDTH, border_value=1)
    edge: BoolArray = mask & ~inside & (length > 0)
    return edge, outward[edge] / length[edge][:, None]


def _measure_curl(normals: FloatArray, mask: BoolArray) -> float:
    """Return the median of |∂p/∂y - ∂q/∂x|, as a share of that of |∂p/∂y| + |∂q/∂x|."""
    inside = ndimage.binary_erosion(mask, iterations=OUTLINE_WIDTH + 1)
    if not inside.any():
        return 1.0
    n_z = np.maximum(np.abs(normals[..., 2]), SMALLEST_N_Z)
    p_y = -np.gradient(-normals[..., 0] / n_z, axis=0)[inside]
    q_x = np.gradient(-normals[..., 1] / n_z, axis=1)[inside]
    scale = float(np.median(np.abs(p_y) + np.abs(q_x)))
    return float(np.median(np.abs(p_y - q_x))) / scale if scale > 0 else 1.0


def describe_axes(matrix: FloatArray) -> str:
    """Return in words where the axes of lights point that a matrix (3, 3) turns.

    >>> describe_axes(np.diag([1, -1, 1]))
    'x points to the right, -y up and z to the camera'
    """
    names = []
    for row in matrix:
        axis = int(np.argmax(np.abs(row)))
        names.append(("-" if row[axis] < 0 else "") + "xyz"[axis])
    return f"{names[0]} points to the right, {names[1]} up and {names[2]} to the camera"
