"""Draws the chart of directional albedo over the angle of incidence, for a report.

The measurement is drawn as dots, and each fit as a line.
"""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.colours import luminance
from brdfkit.materials.auditing.albedos import Albedo, compute_albedo
from brdfkit.regression import Fit
from brdfkit.reporting.charts.svg import Chart, make_linear_axis


def draw_albedo(measured: Albedo, fits: Sequence[Fit], anisotropic: bool) -> str:
    """Return a chart with the luminance of all albedos, as SVG text.

    `measured`: directional albedo of the measurement; `fits`: models to compare with it;
    `anisotropic`: whether the material is anisotropic, so that albedos depend on the azimuth and
    their mean over the azimuth is drawn.
    """
    dots = luminance(measured.values)
    lines = [_compute_albedo_luminance(fit.rgb, anisotropic) for fit in fits]
    top = 1.1 * max(np.nanmax(values) for values in (dots, *lines))
    x = make_linear_axis("θi", 0, 90, range(0, 91, 15), "°")
    ticks = np.arange(0, top, _choose_tick_step(top)).round(6)
    chart = Chart("albedo", x, make_linear_axis("reflected / incident light", 0, top, ticks))
    if top > 1:
        chart.add_horizontal_line(1, "mirror")
    chart.add_fits([(measured.theta_i, values) for values in lines])
    chart.add_dots(measured.theta_i, dots, "measured")
    beyond = is_extrapolated(measured)
    chart.add_dots(measured.theta_i[beyond], dots[beyond], "hollow")
    return chart.svg


def is_extrapolated(measured: Albedo) -> BoolArray:
    """Return the mask (n,) of the albedo's angles that lie beyond the measured angles."""
    beyond: BoolArray = measured.theta_i > measured.measured_to + 1
    return beyond


def _compute_albedo_luminance(model: Any, anisotropic: bool) -> FloatArray:
    """Return the luminance (n,) of a model's albedo at the angles of the measured albedo."""
    grey: Any = SimpleNamespace(
        channels=("Y",),
        anisotropic=anisotropic,
        eval=lambda wi, wo: luminance(model.eval(wi, wo))[:, None],
    )
    return compute_albedo(grey, measured_to=90.0).values[:, 0]


def _choose_tick_step(top: float) -> float:
    """Return the step between ticks of an axis up to `top`: 1, 2 or 5 times a power of ten."""
    power = 10 ** np.floor(np.log10(top))
    return float(power * (1 if top > 4 * power else 0.5 if top > 2 * power else 0.2))
