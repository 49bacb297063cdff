"""Transfer functions of boundaries between materials: triangles over values × gradient magnitudes.

Across a boundary that a scanner blurs, values v change from one material's to the other's, and
their gradient magnitude g is largest near the mean f of both. A shell of constant thickness about
the surface v = f is thus where |v - f| < thickness · g [Levoy 1988]. A triangle that ends at a
`steepest` g omits what passes through the same values faster, such as skin to air [Kniss et al.
2002].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.arguments import to_pair, to_positive
from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError

VALUES, GRADIENTS = 129, 33  # size of the grid that holds the triangles
FADE = 0.25  # share of the steepest gradient within which a boundary fades above it


def from_boundaries(
    cls: Any,
    boundaries: ArrayLike,
    thickness: float,
    values: tuple[float, float],
    extinction: float,
    colour: str,
) -> Any:
    """Return the transfer function, of the class `cls`, of `boundaries`; see `Conversions`."""
    thickness, (low, high) = to_positive("thickness", thickness), to_pair("values", values)
    v = np.linspace(low, high, VALUES)
    rows = _check_rows(boundaries)
    g = np.linspace(0, (1 + FADE) * rows[:, 1].max(), GRADIENTS)[:, None]
    triangles = []
    for level, steepest, *_, a in rows:
        near = 1 - np.abs(v - level) / np.maximum(thickness * g, 1e-12 * (high - low))
        ends = (1 + FADE - g / steepest) / FADE
        triangles.append(a * np.clip(near, 0, 1) * np.clip(ends, 0, 1) * (g > 0))
    shares = np.array(triangles)  # (k, m, n)
    shares[..., [0, -1]] = 0  # beyond its ends a function is constant
    # Where nothing shows, colours still change gradually, because textures are interpolated
    weights = shares + 1e-6 / (1e-3 + np.abs(v - rows[:, 0, None, None]) / (high - low))
    rgb = np.einsum("kmn,kc->mnc", weights / weights.sum(axis=0), rows[:, 2:5])
    rgba = np.dstack([rgb, 1 - np.prod(1 - shares, axis=0)])
    return cls(v, rgba, extinction, colour, g[:, 0], name="boundaries")


def _check_rows(boundaries: ArrayLike) -> FloatArray:
    """Return the rows (k, 6) of boundaries as floats; raise `BrdfkitError` if they are wrong."""
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
