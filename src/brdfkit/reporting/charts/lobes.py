"""The lobes as charts: the BRDF over the angle θo, measured as dots and fitted as lines."""

import numpy as np

from brdfkit.images.thumbnails import Radius
from brdfkit.materials.plotting.plane_of_incidence import choose_angles, compute_lobe, is_scattered
from brdfkit.reporting.charts.svg import BOTTOM, HEIGHT, TOP, Axis, Chart, linear

STEP, APART = 0.5, 3.0  # degrees between the points of a line, and between dots of a table
DOT = 2.0  # radius of a dot, as the style has it: behind it a shorter bar is not seen
PEAK = 4.0  # degrees beside the peak: there lines have all their points, and dots a closer step


def lobe_charts(material, fits, noise):
    """A chart for each of a few incidences, and whether any has bars of the noise.

    `noise`: the standard deviation of a measured value over the value, 0 where it is unknown.
    """
    material = getattr(material, "rgb", material)
    charts = [_chart(material, fits, noise, angle) for angle in choose_angles([material])]
    return [svg for svg, _ in charts], any(barred for _, barred in charts)


def _chart(material, fits, noise, theta_i):
    """The chart of an incidence, and whether it has bars."""
    measured, *fitted = (
        compute_lobe(getattr(thing, "rgb", thing), theta_i) for thing in (material, *fits)
    )
    radius = Radius([values for _, values in (measured, *fitted)])
    ticks = [(value, f"{value:g}") for value in radius.ticks()]
    x = linear("θo, towards the light < 0", -90, 90, range(-90, 91, 30), "°")
    chart = Chart(f"θi = {theta_i:g}°", x, Axis("BRDF [sr⁻¹]", ticks, radius))
    chart.upright(theta_i, "mirror")
    lines = []
    for theta_o, values in fitted:
        shown = _thinned(theta_o, values, STEP)
        lines.append((theta_o[shown], values[shown]))
    chart.fits(lines)
    theta_o, values = measured
    if not is_scattered(material):
        shown = _thinned(theta_o, values, APART)
        theta_o, values = theta_o[shown], values[shown]
    barred = np.log10(1 + noise) / radius.decades * (HEIGHT - TOP - BOTTOM) > DOT
    if barred:
        chart.bars(theta_o, values * max(1 - noise, 0), values * (1 + noise), "measured")
    chart.dots(theta_o, values, "measured")
    return chart.svg, barred


def _thinned(theta_o, values, step):
    """Which points (n,) to draw: one in each `step` [degrees], and six times as many at the
    peak."""
    if not np.isfinite(values).any():
        return np.ones(len(values), bool)
    at_peak = np.abs(theta_o - theta_o[np.nanargmax(values)]) < PEAK
    fine, coarse = (max(1, round(width / 0.1)) for width in (step / 6, step))
    number = np.arange(len(theta_o))
    return (number % coarse == 0) | (at_peak & (number % fine == 0))
