"""Resampling of environment maps to another convention, so that light keeps its direction."""

from math import ceil, sqrt

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.lighting.environments.conventions import Convention, Layout


def resample(
    pixels: AnyArray,
    source: Convention,
    target: Convention,
    height: int,
    turn: float = 0.0,
    mirror: bool = False,
) -> FloatArray:
    """Convert a map (rows, columns, channels) from a `source` to a `target` convention.

    The result has `height` rows. `turn` [degrees] turns the light about the up axis, anticlockwise
    seen from above; `mirror` exchanges left and right of the source. If the target has fewer
    pixels, each is the mean over several directions within it. Blank pixels are 0.
    """
    width = round(height * target.layout.aspect)
    to_source = source.frame.T @ _rotation_about_y(turn).T @ target.frame
    if mirror:
        to_source = np.diag([-1, 1, 1]) @ to_source
    finer = max(1, ceil(sqrt(pixels.shape[0] * pixels.shape[1] / (height * width)) - 0.01))
    offsets = (np.arange(finer) + 0.5) / finer - 0.5
    parts = label_layout_parts(source.layout, *pixels.shape[:2])
    total = np.zeros((height, width, pixels.shape[2]))
    count = np.zeros((height, width, 1))
    for dy in offsets:
        for dx in offsets:
            x, y = np.arange(width)[None, :] + dx, np.arange(height)[:, None] + dy
            towards = target.layout.directions(x, y, height, width) @ to_source.T
            filled = np.isfinite(towards[..., 0])
            total[filled] += look_up_map(pixels, source.layout, towards[filled], parts)
            count[filled] += 1
    return total / np.maximum(count, 1)


def look_up_map(
    pixels: AnyArray, layout: Layout, directions: FloatArray, parts: IntArray | None = None
) -> FloatArray:
    """Return a map's values (n, channels) at `directions` (n, 3), interpolated between pixels.

    `directions` have the components right, up and ahead of the `layout`. `parts`, the result of
    `label_layout_parts`, saves time when a map is looked up repeatedly.
    """
    height, width = pixels.shape[:2]
    parts = label_layout_parts(layout, height, width) if parts is None else parts
    x, y, part = layout.pixel_coordinates(directions, height, width)
    left, above = np.floor(x).astype(int), np.floor(y).astype(int)
    total, weights = np.zeros(1), np.zeros(1)
    for column, across in ((left, left + 1 - x), (left + 1, x - left)):
        for row, down in ((above, above + 1 - y), (above + 1, y - above)):
            i, j = np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)
            if layout.closed:
                j = column % width
            weight = (across * down * (parts[i, j] == part))[:, None]
            total, weights = total + weight * pixels[i, j], weights + weight
    return total / weights


def label_layout_parts(layout: Layout, height: int, width: int) -> IntArray:
    """Return the number of the layout's part, such as a cube's face, for each pixel; -1 if blank.

    The shape is (height, width).
    """
    x, y = np.arange(width)[None, :], np.arange(height)[:, None]
    towards = layout.directions(x, y, height, width)
    parts = np.full((height, width), -1)
    filled = np.isfinite(towards[..., 0])
    parts[filled] = layout.pixel_coordinates(towards[filled], height, width)[2]
    return parts


def _rotation_about_y(degrees: float) -> FloatArray:
    """Return the rotation (3, 3) by `degrees` about y; 90 degrees take +z to +x."""
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
