"""Samples a distance field on a grid of cubic cells."""

from typing import Any

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import Box, format_point
from brdfkit.distance_fields.parameters import find_node_class

MARGIN = 0.05  # width of the margin around the surface's own box [unit of length]


def to_grid(node: Any, resolution: int = 64, bounds: Any = None) -> Any:
    """Return the field as a `grid` of cubic cells, `resolution` of them along the longest edge.

    The grid differs from the field by at most ``node.lipschitz * grid.half_diagonal``. The box is
    `bounds`, (low, high), or the node's own box with a margin.
    """
    low, high = find_box_to_sample(node, bounds)
    axes = make_grid_axes(low, high, resolution)
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = node(points.reshape(-1, 3)).reshape(points.shape[:3])
    if not np.isfinite(values).all():
        place = format_point(points[~np.isfinite(values)][0])
        raise BrdfkitError(f"the field is not finite at {place}; check its formula.")
    if values.min() > 0 or values.max() < 0:
        side = "outside" if values.min() > 0 else "inside"
        raise BrdfkitError(
            f"the box from {format_point(low)} to {format_point(high)} is all {side}: there is no "
            "surface; give other bounds, or a finer resolution."
        )
    return find_node_class("grid")(
        values.transpose(2, 1, 0), tuple(low), tuple(a[-1] for a in axes)
    )


def find_box_to_sample(node: Any, bounds: Any = None) -> Box:
    """Return the box (low, high) to sample: `bounds`, or the surface's own box with a margin.

    Raises `BrdfkitError` for boxes that are infinite, empty or no boxes at all.
    """
    corners = node.bounds() if bounds is None else bounds
    try:
        low, high = np.asarray(corners, float).reshape(2, 3)
    except (TypeError, ValueError):
        raise BrdfkitError(
            f"bounds = {bounds!r} should be two corners, (low, high), of three numbers each."
        ) from None
    if not np.isfinite([low, high]).all():
        raise BrdfkitError("the field is unbounded; give bounds, (low, high).")
    if not (low < high).all():
        raise BrdfkitError(
            f"the box from {format_point(low)} to {format_point(high)} is empty: there is no "
            "surface in it; give other bounds, or another field."
        )
    margin = MARGIN if bounds is None else 0.0
    return low - margin, high + margin


def make_grid_axes(low: FloatArray, high: FloatArray, resolution: int) -> list[FloatArray]:
    """Return the coordinates along x, y and z of cubic cells that cover a box, from `low` on."""
    step = (high - low).max() / to_whole_number("resolution", resolution, least=1)
    counts = np.ceil((high - low) / step - 1e-9).astype(int)
    return [start + step * np.arange(n + 1) for start, n in zip(low, counts, strict=True)]
