"""Distances at NumPy's points, in double precision."""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.threads import in_turn


@in_turn
def evaluate(distance, points):
    """f (n,) of a callable `distance` at `points` (n, 3)."""
    points = np.asarray(points, float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise BrdfkitError(f"points have the shape {points.shape}; it should be (n, 3).")
    if not len(points):
        return np.zeros(0)
    values = np.asarray(distance(double_precision.vector(points)), float)
    return np.broadcast_to(values, len(points)).copy()
