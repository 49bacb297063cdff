"""Transfer functions that show boundaries between materials, as triangles over value and gradient.

Across a boundary that a scanner blurs, the value v changes from one material's to the other's, and
its gradient magnitude g is largest near the mean f of both. The points with
|v - f| < thickness · g thus are a shell of constant thickness around the surface v = f
[Levoy 1988], and a triangle in the plane of v and g. The triangle ends at a `steepest` g, to omit
boundaries that pass through the same values faster, such as from skin to air [Kniss et al. 2002].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number_pair, to_positive_number
from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError

VALUES, GRADIENTS = 129, 33  # numbers of values and of gradients in the function's grid
FADE = 0.25  # A falls to 0 between a boundary's steepest gradient and 1 + FADE times it


def convert_boundaries(
    cls: Any,
    boundaries: ArrayLike,
    thickness: float,
    values: tuple[float, float],
    extinction: float,
    colour: str,
) -> Any:
    """Make a transfer function, of the class `cls`, that shows boundaries between materials.

    See `Conversions.from_boundaries` for the arguments.
    """
    thickness, (low, high) = (
        to_positive_number("thickness", thickness),
        to_number_pair("values", values),
    )
    v = np.linspace(low, high, VALUES)
    rows = _check_boundaries(boundaries)
    g = np.linspace(0, (1 + FADE) * rows[:, 1].max(), GRADIENTS)[:, None]
    triangles = []
    for level, steepest, *_, a in rows:
        near = 1 - np.abs(v - level) / np.maximum(thickness * g, 1e-12 * (high - low))
        ends = (1 + FADE - g / steepest) / FADE
        triangles.append(a * np.clip(near, 0, 1) * np.clip(ends, 0, 1) * (g > 0))
    shares = np.array(triangles)  # A of each triangle, over (boundaries, gradients, values)
    shares[..., [0, -1]] = 0  # A is 0 at both ends of the values, and thus beyond them, too
    # Colours change gradually even where A is 0, because textures mix them with neighbours of A > 0
    weights = shares + 1e-6 / (1e-3 + np.abs(v - rows[:, 0, None, None]) / (high - low))
    rgb = np.einsum("kmn,kc->mnc", weights / weights.sum(axis=0), rows[:, 2:5])
    rgba = np.dstack([rgb, 1 - np.prod(1 - shares, axis=0)])
    return cls(v, rgba, extinction, colour, g[:, 0], name="boundaries")


def _check_boundaries(boundaries: ArrayLike) -> FloatArray:
    """Return the rows (k, 6) of `boundaries` as floats; raise `BrdfkitError` if they are invalid.

    A row is (value, steepest gradient magnitude, R, G, B, A).
    """
    try:
        rows = np.array(boundaries, float)
    except (TypeError, ValueError):
        rows = np.empty(0)
    if rows.ndim != 2 or rows.shape[1:] != (6,) or not np.isfinite(rows).all():
        raise BrdfkitError(
            "boundaries should be rows of six numbers: value, steepest gradient, R, G, B, A."
        )
    if not (rows[:, 1] > 0).all() or not ((rows[:, 2:] >= 0) & (rows[:, 2:] <= 1)).all():
        raise BrdfkitError(
            "boundaries: the steepest gradient is above 0, and R, G, B and A are 0 to 1."
        )
    return rows
