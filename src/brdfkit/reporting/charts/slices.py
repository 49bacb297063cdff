"""Draws slices of the BRDF for a report: the measured one, the fitted ones, and their ratios.

A slice is a picture of the BRDF over the angles θh and θd at φd = 90°. θh is the angle of the half
vector to the normal, θd the angle between half vector and light, and φd the azimuth of the light
around the half vector.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.colours import luminance
from brdfkit.core.pages import images
from brdfkit.materials.auditing.picture import find_measured_cells, make_colour_scale
from brdfkit.materials.measured import Measured
from brdfkit.regression import Fit
from brdfkit.reporting.charts.svg import Axis, Chart, make_linear_axis

VALUE_SCALE, RATIO_SCALE = "viridis", "RdBu_r"
# Largest ratio of fit to data on the colour scale of ratios, which begins at its inverse
LARGEST_RATIO = 4.0
FAINT = 0.3  # opacity of cells whose values were not measured but extrapolated
TICKS = 0, 5, 20, 45, 90  # ticks of the axis of θh [degrees]
WIDTH, HEIGHT = 250, 240


def draw_slices(material: Measured, fits: Sequence[Fit]) -> dict[str, Any]:
    """Return the data of slices for the page's template: SVG charts and labels of colour scales."""
    data = material.rgb
    table = data.table
    across = int(np.argmin(np.abs(table.centres[-1] - np.pi / 2)))
    cells = (0,) * table.anisotropic + (slice(None), slice(None), across)
    wi, wo = (w[cells] for w in table.directions())
    known = find_measured_cells(data, table, cells)
    measured = luminance(table.filled_values[cells])
    scale = make_colour_scale(measured[known] if known.any() else measured)

    def draw_slice(title: str, shares: FloatArray, colour_map: str) -> str:
        """Return a slice as SVG text; `shares` has positions on a colour map, by θh and θd."""
        colours = images.apply_colour_map(colour_map, shares)
        colours[..., 3] = np.where(known, 1, FAINT)
        theta_d = make_linear_axis("θd", 0, 90, range(0, 91, 30), "°")
        chart = Chart(title, _make_theta_h_axis(), theta_d, WIDTH, HEIGHT)
        # A PNG begins with its top row, but θd increases upwards
        chart.add_image(images.encode_png(np.swapaxes(colours, 0, 1)[::-1]))
        return chart.svg

    def to_scale_positions(values: FloatArray) -> FloatArray:
        """Return BRDF values as positions from 0 to 1 on the logarithmic scale of colours."""
        floor = np.maximum(values, scale.vmin)
        return np.log(floor / scale.vmin) / np.log(scale.vmax / scale.vmin)

    pairs = []
    for fit in fits:
        values = luminance(fit.rgb.eval(wi.reshape(-1, 3), wo.reshape(-1, 3))).reshape(known.shape)
        floor = 1e-3 * scale.vmin
        ratio = np.maximum(values, floor) / np.maximum(measured, floor)
        shares = np.log(ratio) / np.log(LARGEST_RATIO) / 2 + 0.5
        fitted = draw_slice("fit", to_scale_positions(values), VALUE_SCALE)
        pairs.append((fitted, draw_slice("fit / data", shares, RATIO_SCALE)))
    return {
        "measured": draw_slice("data", to_scale_positions(measured), VALUE_SCALE),
        "fits": pairs,
        "lowest": _format_value(scale.vmin),
        "highest": _format_value(scale.vmax),
        "values_bar": images.draw_colour_bar(VALUE_SCALE),
        "ratios_bar": images.draw_colour_bar(RATIO_SCALE),
        "largest_ratio": f"{LARGEST_RATIO:g}",
        "all_known": bool(known.all()),
    }


def _format_value(value: float) -> str:
    """Return a BRDF value as short text, for the ends of the scale of colours."""
    return f"{value:,.0f}" if value >= 10 else f"{value:.2g}"


def _make_theta_h_axis() -> Axis:
    """Return the axis of θh, proportional to √θh so that all cells have the same width."""
    ticks = [(tick, f"{tick}°") for tick in TICKS]
    return Axis("θh", ticks, lambda value: np.sqrt(np.asarray(value, float) / 90))
