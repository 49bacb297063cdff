"""Draws the charts of a BRDF's lobes for a report, over the outgoing angle θo.

The measurement is drawn as dots, with bars for its noise, and each fit as a line. The dots of a
completed material are fainter where they were inferred or guessed; its bars are 95 % intervals.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.images.thumbnails import Radius
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.evidence import NAMES
from brdfkit.materials.plotting.plane_of_incidence import (
    choose_angles,
    compute_certainty,
    compute_lobe,
    is_completed,
    is_scattered,
)
from brdfkit.reporting.charts.svg import BOTTOM, HEIGHT, TOP, Axis, Chart, make_linear_axis

# Degrees between the points of a line, and between the dots of a measured table
LINE_STEP, DOT_STEP = 0.5, 3.0
# Degrees between the values that `compute_lobe` returns
SAMPLING = 0.1
# Radius of a dot [pixels], as in the page's style sheet; bars that a dot would hide are not drawn
DOT_RADIUS = 2.0
# Points are six times as dense within this many degrees on each side of a lobe's peak
PEAK_WIDTH = 4.0


def draw_lobes(material: Any, fits: Sequence[Any], noise: float) -> tuple[list[str], bool]:
    """Return charts as SVG texts, one for each of a few angles of incidence.

    Return also whether any chart has bars for the noise. `material`: the measurement; `noise`:
    relative standard deviation of a measured value, or 0 if it is unknown.
    """
    material = getattr(material, "rgb", material)
    charts = [_draw_lobe(material, fits, noise, angle) for angle in choose_angles([material])]
    return [svg for svg, _ in charts], any(has_bars for _, has_bars in charts)


def _draw_lobe(
    material: Any, fits: Sequence[Any], noise: float, theta_i: float
) -> tuple[str, bool]:
    """Return the chart for one angle of incidence, and whether it has bars for the noise.

    `theta_i`: the angle [degrees]; the other arguments are those of `draw_lobes`.
    """
    measured, *fitted = (
        compute_lobe(getattr(thing, "rgb", thing), theta_i) for thing in (material, *fits)
    )
    radius = Radius([values for _, values in (measured, *fitted)])
    ticks = [(value, f"{value:g}") for value in radius.ticks()]
    x = make_linear_axis("θo, towards the light < 0", -90, 90, range(-90, 91, 30), "°")
    chart = Chart(f"θi = {theta_i:g}°", x, Axis("BRDF [sr⁻¹]", ticks, radius))
    chart.add_vertical_line(theta_i, "mirror")
    lines = []
    for theta_o, values in fitted:
        shown = _choose_points(theta_o, values, LINE_STEP)
        lines.append((theta_o[shown], values[shown]))
    chart.add_fits(lines)
    theta_o, values = measured
    if not is_scattered(material):
        shown = _choose_points(theta_o, values, DOT_STEP)
        theta_o, values = theta_o[shown], values[shown]
    if is_completed(material):
        add_certain_dots(chart, material, theta_i, theta_o, values)
        return chart.svg, False
    has_bars = bool(np.log10(1 + noise) / radius.decades * (HEIGHT - TOP - BOTTOM) > DOT_RADIUS)
    if has_bars:
        chart.add_bars(theta_o, values * max(1 - noise, 0), values * (1 + noise), "measured")
    chart.add_dots(theta_o, values, "measured")
    return chart.svg, has_bars


def add_certain_dots(
    chart: Chart, material: Measured, theta_i: float, theta_o: FloatArray, values: FloatArray
) -> None:
    """Add dots of a completed material, by evidence, with bars for their 95 % intervals."""
    kinds, low, high = compute_certainty(material, theta_i, theta_o)
    chart.add_bars(theta_o, low, high, "measured")
    for kind, name in enumerate(NAMES):
        rows = kinds == kind
        chart.add_dots(theta_o[rows], values[rows], f"measured by-{name}")


def _choose_points(theta_o: FloatArray, values: FloatArray, step: float) -> BoolArray:
    """Return for each point (n,) of a lobe whether to draw it: one per `step`, more at the peak.

    `theta_o`: outgoing angles [degrees]; `values`: the BRDF there; `step`: degrees between points.
    """
    if not np.isfinite(values).any():
        return np.ones(len(values), bool)
    at_peak = np.abs(theta_o - theta_o[np.nanargmax(values)]) < PEAK_WIDTH
    fine, coarse = (max(1, round(width / SAMPLING)) for width in (step / 6, step))
    number = np.arange(len(theta_o))
    return (number % coarse == 0) | (at_peak & (number % fine == 0))
