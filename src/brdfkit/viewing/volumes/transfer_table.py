"""Converts the transfer function of a view's state to the table that a `LiveScene` shows, and back.

The state has one of three kinds: "points", linear between control points over the values; "bumps",
Gaussians over the values; "bumps2d", Gaussians over values × gradient magnitudes [Lesar 2018, as in
his program VPT]. A bump at (x₀, y₀) with the sizes s_x, s_y and the opacity a has

    A = a exp(-((x - x₀)/s_x)² - ((y - y₀)/s_y)²)

and its colour; later bumps lie over earlier ones. x and y are shares of the range of values and of
the steepest gradient magnitude.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from brdfkit.core.arguments import is_number
from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.colours import from_srgb, to_srgb
from brdfkit.viewing.controls import State, is_colour
from brdfkit.viewing.volumes.live_volume import LiveVolume
from brdfkit.volumes import TransferFunction
from brdfkit.volumes.volume import LARGEST_VALUE

POINTS = 24  # control points at most, to which a function is simplified
TOLERANCE = 0.01  # of RGB and A, by which a simplified function may deviate
LARGEST_POINTS, LARGEST_BUMPS = 256, 64
# The ends of a bump's numbers
BUMP_ENDS = {"a": (0, 1), "x": (-1, 2), "y": (-1, 2), "sx": (1e-4, 4), "sy": (1e-4, 4)}


def to_table(state: State, volume: LiveVolume) -> AnyArray:
    """Return RGBA of a state's points or bumps at the rows of a table.

    It is (VALUE_ROWS, 4), or (GRADIENT_ROWS, VALUE_ROWS, 4) for bumps over gradients.
    """
    mode = state["transfer.mode"]
    if mode == "points":
        return table_of_points(state["transfer.points"], volume.row_values)
    table = table_of_bumps(state["transfer.bumps"], volume, by_gradients=mode == "bumps2d")
    return table if mode == "bumps2d" else table[0]


def table_of_points(points: list[Any], values: FloatArray) -> FloatArray:
    """Return RGBA (n, 4) of control points [value, "#rrggbb", A] at n values.

    Two points at one value are a jump.
    """
    at = np.array([point[0] for point in points], float)
    rgba = np.array([[*parse_colour(point[1]), point[2]] for point in points], float)
    return np.stack([np.interp(values, at, channel) for channel in rgba.T], axis=-1)


def table_of_function(function: TransferFunction, volume: LiveVolume) -> FloatArray:
    """Return RGBA of a function at the rows of a table, over gradients if it depends on them."""
    if function.gradients is None:
        return function(volume.row_values)
    return function(volume.row_values, volume.row_gradients[:, None])


def table_of_bumps(
    bumps: list[dict[str, Any]], volume: LiveVolume, by_gradients: bool
) -> FloatArray:
    """Return RGBA (m, VALUE_ROWS, 4) of bumps; m is 1 if they do not depend on gradients."""
    x = (volume.row_values - volume.low) / (volume.high - volume.low)
    y = (volume.row_gradients / volume.steepest)[:, None] if by_gradients else np.zeros((1, 1))
    premultiplied, alpha = np.zeros((len(y), len(x), 3)), np.zeros((len(y), len(x)))
    for bump in bumps:
        along = np.exp(-(((x - bump["x"]) / bump["sx"]) ** 2))
        up = np.exp(-(((y - bump["y"]) / bump["sy"]) ** 2)) if by_gradients else 1.0
        a = bump["a"] * along * up
        rgb = parse_colour(bump["colour"])
        premultiplied = a[..., None] * rgb + (1 - a[..., None]) * premultiplied
        alpha = a + (1 - a) * alpha
    rgb = premultiplied / np.maximum(alpha, 1e-9)[..., None]
    return np.concatenate([np.clip(rgb, 0, 1), alpha[..., None]], axis=-1)


def parse_colour(text: str) -> FloatArray:
    """Return "#rrggbb", in sRGB, as linear RGB (3,)."""
    return from_srgb(np.array([int(text[k : k + 2], 16) for k in (1, 3, 5)]) / 255)


def format_colour(rgb: FloatArray) -> str:
    """Return linear RGB (3,) as "#rrggbb", in sRGB."""
    return "#" + "".join(f"{round(255 * channel):02x}" for channel in to_srgb(rgb).tolist())


def to_points(function: TransferFunction, low: float, high: float) -> list[list[Any]]:
    """Return a function's control points [value, "#rrggbb", A], simplified to at most `POINTS`.

    They go from the value `low` to `high`. A function of gradient magnitudes is replaced by its
    largest A over all of them.
    """
    rgba = function.rgba
    if function.gradients is not None:
        rgba = np.take_along_axis(rgba, rgba[..., 3:].argmax(axis=0)[None], axis=0)[0]
    at = np.asarray(function.values, float)
    inside = (at > low) & (at < high)
    ends = np.stack([[np.interp(end, at, c) for c in rgba.T] for end in (low, high)])
    at = np.concatenate([[low], at[inside], [high]])
    rgba = np.concatenate([ends[:1], rgba[inside], ends[1:]])
    return _simplify(at, rgba)


def change_points(
    points: list[Any], at: FloatArray, weights: FloatArray, reduce: bool, most: int = POINTS
) -> list[list[Any]]:
    """Return control points with A raised by `weights`, or reduced by these shares of itself.

    The weights (n,) are those at the values `at`, and linear between them. The points are
    simplified to at most `most`.
    """
    own = np.array([point[0] for point in points], float)
    rgba = np.array([[*parse_colour(point[1]), point[2]] for point in points], float)
    new = at[~np.isin(at, own) & (at > own[0]) & (at < own[-1])]
    between = np.stack([np.interp(new, own, channel) for channel in rgba.T], axis=1)
    values, rgba = np.concatenate([own, new]), np.concatenate([rgba, between])
    order = np.argsort(values, kind="stable")
    values, rgba = values[order], rgba[order]
    weight = np.interp(values, at, weights)
    a = rgba[:, 3] * (1 - weight) if reduce else rgba[:, 3] + weight
    rgba[:, 3] = np.clip(a, 0, 1)
    return _simplify(values, rgba, most)


def _simplify(at: FloatArray, rgba: FloatArray, most: int = POINTS) -> list[list[Any]]:
    """Return the control points of a polyline, at most `most`; A counts by its largest value."""
    largest = max(float(rgba[:, 3].max()), 1e-9)
    scaled = np.column_stack([rgba[:, :3], rgba[:, 3] / largest])
    kept = _choose_points(at, scaled, most)
    return [[float(at[k]), format_colour(rgba[k, :3]), float(rgba[k, 3])] for k in kept]


def _choose_points(at: FloatArray, rgba: FloatArray, most: int) -> list[int]:
    """Return the points to keep of a polyline: always the one next that deviates most."""
    kept = [0, len(at) - 1]
    while len(kept) < min(most, len(at)):
        kept.sort()
        line = np.stack([np.interp(at, at[kept], channel[kept]) for channel in rgba.T], axis=1)
        deviation = np.abs(line - rgba).max(axis=1)
        deviation[kept] = 0
        if deviation.max() < TOLERANCE:
            break
        kept.append(int(deviation.argmax()))
    return sorted(kept)


def is_points(points: Any) -> bool:
    """Return whether a value is a list of two or more control points, rising."""
    if not isinstance(points, list) or not 2 <= len(points) <= LARGEST_POINTS:
        return False
    if not all(isinstance(point, list) and len(point) == 3 for point in points):
        return False
    if not all(_is_between(v, -LARGEST_VALUE, LARGEST_VALUE) for v, _, _ in points):
        return False
    rising = all(a[0] <= b[0] for a, b in pairwise(points)) and points[0][0] < points[-1][0]
    return rising and all(is_colour(c) and _is_between(a, 0, 1) for _, c, a in points)


def is_bumps(bumps: Any) -> bool:
    """Return whether a value is a list of bumps."""
    return (
        isinstance(bumps, list)
        and len(bumps) <= LARGEST_BUMPS
        and all(
            isinstance(bump, dict)
            and all(_is_between(bump.get(name), *ends) for name, ends in BUMP_ENDS.items())
            and is_colour(bump.get("colour"))
            for bump in bumps
        )
    )


def _is_between(value: Any, low: float, high: float) -> bool:
    """Return whether a value is a number from `low` to `high`."""
    return is_number(value) and low <= value <= high
