"""Draws a `Plan`: the places of light and detector, numbered, and the falling error."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.figures import Plot

LIGHT, DETECTOR = "#d55e00", "#0072b2"
NUMBER = "#fff8dd"  # no grey: those of notebooks are replaced
SIZE = 9.6, 4.4  # inches
MOST_NUMBERS = 99  # larger numbers do not fit into a mark
APART = 5.6  # least distance of two marks in a row of lights [degrees]
HIDDEN = 4.5  # a mark that is nearer to another one hides its number [degrees]
RINGS = np.array([1.0, 1.5])  # radii of the places to which it moves, in multiples of this distance
ROW, MOST_ROWS = 7.0, 6  # distance of two rows of lights [degrees], and how many there are
NARROW = 5.0  # errors that differ by a smaller factor have more ticks
SMALL_TEXT = {"size": 8, "color": "0.35"}


def draw_plan(plan: Any) -> Plot:
    """Draw the directions of a `Plan` on the half hemisphere seen from above, and its errors."""
    figure = Plot(figsize=SIZE, layout="constrained")
    places, errors = figure.subplots(1, 2, width_ratios=(1.55, 1))
    draw_places(places, plan.angles)
    draw_errors(errors, plan)
    return figure


def draw_places(axes: Any, angles: AnyArray) -> None:
    """Draw numbered marks: detectors above the line of the light's azimuth, lights below it."""
    rows = stack(angles[:, 0])
    bottom = -ROW * (rows.max() + 1.9)
    axes.set(aspect="equal", xlim=(-101, 101), ylim=(bottom - 10, 101))
    axes.set_axis_off()
    half = np.radians(np.arange(0, 181))
    for theta in (30, 60, 90):
        axes.plot(theta * np.cos(half), theta * np.sin(half), color="0.8", linewidth=0.8, zorder=1)
        axes.text(theta * np.cos(1.83), theta * np.sin(1.83), f"{theta}°", **SMALL_TEXT)
    for phi in range(0, 181, 30):
        turn = np.radians(phi)
        axes.plot([0, 90 * np.cos(turn)], [0, 90 * np.sin(turn)], color="0.9", lw=0.7, zorder=1)
        at = 97 * np.cos(turn), 97 * np.sin(turn)
        axes.text(*at, f"{phi}°", ha="center", va="center", **SMALL_TEXT)
    x, y = (angles[:, 1] * f(np.radians(angles[:, 2])) for f in (np.cos, np.sin))
    draw_marks(axes, *spread(x, y), DETECTOR)
    draw_marks(axes, angles[:, 0], -ROW * (rows + 1), LIGHT)
    axes.text(-90, -5, "detector, at θo and φ", ha="left", va="top", size=9, color=DETECTOR)
    words = "light, at θi in the plane below 0°"
    axes.text(90, bottom, words, ha="right", va="top", size=9, color=LIGHT)


def draw_marks(axes: Any, x: AnyArray, y: AnyArray, colour: str) -> None:
    """Draw numbered marks at points (n,); the first ones lie above the others."""
    for k in range(len(x)):
        height = 3 + (len(x) - k) / len(x)
        axes.plot(x[k], y[k], "o", color=colour, ms=10, mec="white", mew=0.6, zorder=height)
        if k < MOST_NUMBERS:
            style = {"ha": "center", "va": "center_baseline", "color": NUMBER, "size": 6.5}
            axes.text(x[k], y[k], str(k + 1), zorder=height, **style)


def spread(x: AnyArray, y: AnyArray) -> tuple[AnyArray, AnyArray]:
    """Return points (n,) near to those given, so that every mark is seen.

    A mark that would hide behind an earlier one moves to the nearest free place of rings around its
    own, above the line of the light's azimuth.
    """
    placed = np.empty((0, 2))
    turn = np.radians(np.arange(0, 360, 15))
    rings = [r * np.stack([np.cos(turn), np.sin(turn)], axis=1) for r in HIDDEN * RINGS]
    steps = np.concatenate([np.zeros((1, 2)), *rings])
    for point in np.stack([x, y], axis=1)[:MOST_NUMBERS]:
        places = point + steps
        gaps = np.linalg.norm(places[:, None] - placed, axis=2).min(axis=1, initial=np.inf)
        free = np.flatnonzero((gaps > HIDDEN * 0.99) & (places[:, 1] >= min(point[1], 0) - 1e-9))
        placed = np.vstack([placed, places[free[0] if len(free) else 0]])
    rest = np.stack([x, y], axis=1)[MOST_NUMBERS:]
    moved = np.vstack([placed, rest])
    return moved[:, 0], moved[:, 1]


def stack(theta: AnyArray) -> AnyArray:
    """Return the rows (n,) in which marks at the angles `theta` [degrees] hardly overlap."""
    taken: list[list[float]] = [[] for _ in range(MOST_ROWS)]
    rows = np.zeros(len(theta), int)
    for k, angle in enumerate(theta.tolist()):
        gaps = [min((abs(angle - a) for a in row), default=90.0) for row in taken]
        free = (r for r, gap in enumerate(gaps) if gap >= APART)
        rows[k] = next(free, int(np.argmax(gaps)))
        taken[rows[k]].append(angle)
    return rows


def draw_errors(axes: Any, plan: Any) -> None:
    """Draw the expected error over the number of measured directions."""
    number = np.arange(len(plan.errors))
    axes.plot(number, plan.errors, color="0.2", linewidth=1.6)
    axes.plot(number[1:], plan.errors[1:], "o", color="0.2", markersize=3)
    axes.set_yscale("log")
    low, high = 0.85 * min(plan.errors), 1.2 * max(plan.errors)
    steps = (1, 2, 5) if high > NARROW * low else (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8)
    ticks = [t * p for p in (0.01, 0.1, 1.0) for t in steps if low < t * p < high]
    axes.set_yticks(ticks, [f"{t:g}" for t in ticks])
    axes.minorticks_off()
    for tick in ticks:
        axes.axhline(tick, color="0.87", linewidth=0.7, zorder=0)
    axes.set_ylim(low, high)
    axes.set_xlabel("measured directions")
    axes.set_title("expected error of ln f", fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)
