"""Draws lobes of a completed material: lines by evidence, with a band of 95 % intervals."""

from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from brdfkit.core.array_types import AnyArray
from brdfkit.images.thumbnails import Radius, split_runs
from brdfkit.materials.measured.evidence import GUESSED, NAMES

LINES: tuple[Any, ...] = (
    "-",
    (0, (4, 1.5)),
    (0, (1, 1.5)),
)  # styles of measured, inferred and guessed lines
HATCH, OPACITY = "////", 0.18  # of the band
GREY = "0.45"
EVIDENCE_LABELS = *NAMES, "95 % interval", "95 % of a guess"


def draw_certain_lobe(
    axes: Any,
    radius: Radius,
    theta_o: AnyArray,
    values: AnyArray,
    certainty: tuple[AnyArray, AnyArray, AnyArray],
    style: dict[str, Any],
) -> None:
    """Draw a lobe, `values` (n,) at `theta_o` (n,) [degrees], with its band, into a polar plot.

    `certainty`: evidence and ends of the intervals, as `compute_certainty` returns them. `style`:
    keyword arguments for the line.
    """
    kinds, low, high = certainty
    style = dict(style)
    label = style.pop("label")
    axes.plot([], [], **style, label=label)
    for kind, run in split_runs(kinds):
        theta = theta_o[run]
        ends = np.concatenate([radius(low[run]), np.minimum(radius(high[run]), 1.1)[::-1]])
        x, y = polar_to_xy(np.concatenate([theta, theta[::-1]]), ends)
        known = np.isfinite(x) & np.isfinite(y)
        look = {"color": style["color"], "zorder": 1.6, "linewidth": 0}
        axes.fill(x[known], y[known], alpha=OPACITY, **look)
        if kind == GUESSED:
            look = {"facecolor": "none", "edgecolor": style["color"], "zorder": 1.6}
            axes.fill(x[known], y[known], alpha=0.5, hatch=HATCH, linewidth=0, **look)
        line = polar_to_xy(theta, radius(values[run]))
        axes.plot(*line, **style | {"linestyle": LINES[kind], "dash_capstyle": "butt"})


def make_evidence_handles() -> list[Any]:
    """Return what the legend shows for `EVIDENCE_LABELS`."""
    lines = [Line2D([], [], color=GREY, linestyle=style, linewidth=2) for style in LINES]
    band: dict[str, Any] = {"facecolor": GREY, "linewidth": 0}
    guess: dict[str, Any] = {"facecolor": "0.9", "edgecolor": GREY, "hatch": HATCH, "linewidth": 0}
    return [*lines, Patch(**band, alpha=2 * OPACITY), Patch(**guess)]


def polar_to_xy(theta: Any, radius: Any) -> tuple[Any, Any]:
    """Convert polar coordinates of a plot to x and y.

    `theta` is the angle to the normal [degrees], which points up; positive angles are on the right.
    """
    return radius * np.sin(np.radians(theta)), radius * np.cos(np.radians(theta))
