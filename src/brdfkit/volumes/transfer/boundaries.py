"""Boundaries between materials, as triangles of values × gradient magnitudes.

Across a boundary that a scanner blurs, values go from one material's to the other's, and are the
steeper the nearer they are to the mean of both. So a shell of one thickness about the surface of
that value f is where |v - f| < thickness · g [Levoy 1988]. A triangle that ends at a `steepest` g
leaves out what goes through the same values faster, such as skin to air [Kniss et al. 2002].
"""

import numpy as np

from brdfkit.core.arguments import to_pair, to_positive
from brdfkit.core.errors import BrdfkitError

VALUES, GRADIENTS = 129, 33  # of the grid that holds the triangles
FADE = 0.25  # of the steepest gradient: how far above it a boundary fades


def function(cls, rows, thickness, values, extinction, colour):
    """The transfer function, of the class `cls`, of boundaries; see `from_boundaries`."""
    thickness, (low, high) = to_positive("thickness", thickness), to_pair("values", values)
    v = np.linspace(low, high, VALUES)
    rows = _checked(rows)
    g = np.linspace(0, (1 + FADE) * rows[:, 1].max(), GRADIENTS)[:, None]
    shares = []
    for level, steepest, *_, a in rows:
        near = 1 - np.abs(v - level) / np.maximum(thickness * g, 1e-12 * (high - low))
        ends = (1 + FADE - g / steepest) / FADE
        shares.append(a * np.clip(near, 0, 1) * np.clip(ends, 0, 1) * (g > 0))
    shares = np.array(shares)  # (k, m, n)
    shares[..., [0, -1]] = 0  # beyond its ends a function stays as it is there
    # Where none shows, the colours still go from one to the next: textures are interpolated
    weights = shares + 1e-6 / (1e-3 + np.abs(v - rows[:, 0, None, None]) / (high - low))
    rgb = np.einsum("kmn,kc->mnc", weights / weights.sum(axis=0), rows[:, 2:5])
    rgba = np.dstack([rgb, 1 - np.prod(1 - shares, axis=0)])
    return cls(v, rgba, extinction, colour, g[:, 0], name="boundaries")


def _checked(rows):
    try:
        rows = np.array(rows, float)
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
