"""Axes of grids in the world, from how headers state them."""

import numpy as np

LPS_TO_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])


def transform(directions, spacing, origin):
    """(4, 4) of a grid: a column of `directions` (3, 3) for each axis, `spacing`, `origin` (3,)."""
    to_world = np.eye(4)
    to_world[:3, :3] = np.asarray(directions, float) * np.asarray(spacing, float)
    to_world[:3, 3] = origin
    return to_world
