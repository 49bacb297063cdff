"""The map of colour differences between both sides of a view, as it is shown: CIEDE2000."""

from __future__ import annotations

from collections.abc import Collection
from functools import cache
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.colours import from_srgb
from brdfkit.images.errors.colour_difference import ciede2000
from brdfkit.viewing.controls import State

TOPS = (5, 10, 20, 50, 100)  # differences that the brightest colour may stand for
LEVELS = 256  # of colour
MARKS = 8  # colours that describe the map to the page


def shows_differences(state: State, sides: Collection[int]) -> bool:
    """Return whether a state shows the map of differences, of the sides that there are."""
    return state.get("compare") == "difference" and len(sides) > 1


def compare_colours(first: AnyArray, second: AnyArray) -> AnyArray:
    """Return ΔE of colours (..., 3), sRGB in 8 bits; equal ones take no time."""
    difference = np.zeros(first.shape[:-1], np.float32)
    differs = (first != second).any(axis=-1)
    linear = from_srgb(np.linspace(0, 1, LEVELS)).astype(np.float32)
    difference[differs] = ciede2000(linear[first[differs]], linear[second[differs]])
    return difference


def draw_differences(
    first: AnyArray, second: AnyArray, mask: AnyArray | None = None
) -> tuple[AnyArray, dict[str, Any]]:
    """Return the map (height, width, 3), sRGB in 8 bits, and what the page says about it.

    `mask` (height, width) is where the mean is taken, or None for everywhere. The brightest colour
    stands for one of `TOPS`, such that at most 5 % are beyond.
    """
    difference = compare_colours(first, second)
    counted = difference if mask is None else difference[mask]
    counted = counted if counted.size else difference
    upper = float(np.quantile(counted, 0.95))
    top = next(top for top in TOPS if upper <= top or top == TOPS[-1])
    colours = load_colours()
    codes = np.minimum(difference * ((LEVELS - 1) / top), LEVELS - 1).astype(np.uint8)
    marks = [f"rgb({r}, {g}, {b})" for r, g, b in colours[:: (LEVELS - 1) // MARKS]]
    return colours[codes], {
        "mean": float(counted.mean()),
        "upper": upper,
        "top": top,
        "colours": marks,
    }


@cache
def load_colours() -> AnyArray:
    """Return the colours (256, 3) of the map, sRGB in 8 bits, from black to bright."""
    import matplotlib as mpl

    return (255 * mpl.colormaps["magma"](np.arange(LEVELS))[:, :3] + 0.5).astype(np.uint8)
