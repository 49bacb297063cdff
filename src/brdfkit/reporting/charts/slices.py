"""Slices of the BRDF over θh and θd at φd = 90°: measured, fitted, and fitted over measured."""

import numpy as np

from brdfkit.core.colours import luminance
from brdfkit.core.pages import images
from brdfkit.materials.auditing.picture import is_measured, make_scale
from brdfkit.reporting.charts.svg import Axis, Chart, linear

VALUES, RATIOS = "viridis", "RdBu_r"
MOST = 4.0  # times too bright, or too dark: the ends of the scale of ratios
FAINT = 0.3  # opacity of cells that were not measured
TICKS = 0, 5, 20, 45, 90  # degrees of θh
SIZE = {"width": 250, "height": 240}


def slice_charts(material, fits):
    """Charts: of the measurement, a pair (fit, ratio) of each fit; and the scale of the values."""
    data = material.rgb
    table = data.table
    across = int(np.argmin(np.abs(table.centres[-1] - np.pi / 2)))
    cells = (0,) * table.anisotropic + (slice(None), slice(None), across)
    wi, wo = (w[cells] for w in table.directions())
    known = is_measured(data, table, cells)
    measured = luminance(table.filled_values[cells])
    scale = make_scale(measured[known] if known.any() else measured)

    def draw(title, shares, palette):
        colours = images.apply_colour_map(palette, shares)
        colours[..., 3] = np.where(known, 1, FAINT)
        chart = Chart(title, _theta_h(), linear("θd", 0, 90, range(0, 91, 30), "°"), **SIZE)
        chart.image(images.encode_png(np.swapaxes(colours, 0, 1)[::-1]))  # θd upwards
        return chart.svg

    def shares(values):
        floor = np.maximum(values, scale.vmin)
        return np.log(floor / scale.vmin) / np.log(scale.vmax / scale.vmin)

    pairs = []
    for fit in fits:
        values = luminance(fit.rgb.eval(wi.reshape(-1, 3), wo.reshape(-1, 3))).reshape(known.shape)
        floor = 1e-3 * scale.vmin
        ratio = np.log(np.maximum(values, floor) / np.maximum(measured, floor)) / np.log(MOST)
        pairs.append(
            (draw("fit", shares(values), VALUES), draw("fit / data", ratio / 2 + 0.5, RATIOS))
        )
    return {
        "measured": draw("data", shares(measured), VALUES),
        "fits": pairs,
        "least": _short(scale.vmin),
        "most": _short(scale.vmax),
        "values_bar": images.draw_colour_bar(VALUES),
        "ratios_bar": images.draw_colour_bar(RATIOS),
        "times": f"{MOST:g}",
        "all_known": bool(known.all()),
    }


def _short(value):
    return f"{value:,.0f}" if value >= 10 else f"{value:.2g}"


def _theta_h():
    """The axis of θh, spaced as in a table: by the square root."""
    ticks = [(tick, f"{tick}°") for tick in TICKS]
    return Axis("θh", ticks, lambda value: np.sqrt(np.asarray(value, float) / 90))
