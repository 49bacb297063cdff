"""Axis-aligned bounding boxes of surfaces, each a pair (low, high) of opposite corners (3,)."""

from collections.abc import Iterable
from itertools import product
from typing import Any, TypeAlias

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray, JitFloat

Box: TypeAlias = tuple[FloatArray, FloatArray]

EVERYWHERE: Box = np.full(3, -np.inf), np.full(3, np.inf)


def to_floats(value: JitFloat | tuple[JitFloat, ...]) -> Any:
    """Return a field's parameter as a float, or a triple as an array (3,), without derivatives.

    Only the first entry of a Dr.Jit array is returned.
    """
    if isinstance(value, tuple):
        return np.array([to_floats(v) for v in value])
    return float(np.ravel(dr.detach(value))[0]) if dr.is_array_v(value) else float(value)


def bound_points(*points: ArrayLike, margin: float) -> Box:
    """Return the box around points (3,), grown by `margin` [unit of length] on all sides."""
    corners = [np.asarray(p, float) for p in points]
    return np.minimum.reduce(corners) - margin, np.maximum.reduce(corners) + margin


def join_boxes(boxes: Iterable[Box]) -> Box:
    """Return the smallest box that contains several boxes."""
    low, high = zip(*boxes, strict=True)
    return np.minimum.reduce(low), np.maximum.reduce(high)


def intersect_boxes(boxes: Iterable[Box]) -> Box:
    """Return the box that several boxes have in common."""
    low, high = zip(*boxes, strict=True)
    return np.maximum.reduce(low), np.minimum.reduce(high)


def rotate_box(box: Box, matrix: FloatArray) -> Box:
    """Return a box around `box` rotated by a matrix (3, 3); `EVERYWHERE` if it is unbounded."""
    if not np.isfinite(box).all():
        return EVERYWHERE
    corners = np.array(list(product(*np.transpose(box)))) @ matrix.T
    return corners.min(axis=0), corners.max(axis=0)


def format_point(p: AnyArray) -> str:
    """Return a point (3,) as text for an error message."""
    return f"({', '.join(f'{c:.3g}' for c in p)})"
