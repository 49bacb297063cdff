"""Boxes that bound surfaces, as (low, high) of NumPy's numbers; `EVERYWHERE` bounds all."""

from itertools import product

import drjit as dr
import numpy as np

EVERYWHERE = np.full(3, -np.inf), np.full(3, np.inf)


def plain(value):
    """A parameter as plain numbers: of arrays of Dr.Jit's their first entry, without derivative."""
    if isinstance(value, tuple):
        return np.array([plain(v) for v in value])
    return float(np.ravel(dr.detach(value))[0]) if dr.is_array_v(value) else float(value)


def around(*points, reach):
    """The box of points (3,), grown by `reach` [length] on all sides."""
    points = [np.asarray(p, float) for p in points]
    return np.minimum.reduce(points) - reach, np.maximum.reduce(points) + reach


def join(boxes):
    """The box around several boxes."""
    low, high = zip(*boxes, strict=True)
    return np.minimum.reduce(low), np.maximum.reduce(high)


def overlap(boxes):
    """The box that several boxes have in common."""
    low, high = zip(*boxes, strict=True)
    return np.maximum.reduce(low), np.minimum.reduce(high)


def turn(box, matrix):
    """The box around a turned box; one that is endless bounds nothing any more."""
    if not np.isfinite(box).all():
        return EVERYWHERE
    corners = np.array(list(product(*np.transpose(box)))) @ matrix.T
    return corners.min(axis=0), corners.max(axis=0)
