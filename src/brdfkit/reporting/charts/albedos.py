"""The albedo over the angle of incidence as a chart: measured as dots, fitted as lines."""

from types import SimpleNamespace

import numpy as np

from brdfkit.core.colours import luminance
from brdfkit.materials.auditing.albedos import compute_albedo
from brdfkit.reporting.charts.svg import Chart, linear


def albedo_chart(measured, fits, anisotropic):
    """The chart of luminances; `measured`: the `Albedo` of the measurement, which may be
    `anisotropic`."""
    dots = luminance(measured.values)
    lines = [_albedo(fit.rgb, anisotropic) for fit in fits]
    most = 1.1 * max(np.nanmax(values) for values in (dots, *lines))
    x = linear("θi", 0, 90, range(0, 91, 15), "°")
    y = linear("reflected / incident light", 0, most, np.arange(0, most, _step(most)).round(6))
    chart = Chart("albedo", x, y)
    if most > 1:
        chart.across(1, "mirror")
    chart.fits([(measured.theta_i, values) for values in lines])
    chart.dots(measured.theta_i, dots, "measured")
    guessed = is_guessed(measured)
    chart.dots(measured.theta_i[guessed], dots[guessed], "hollow")
    return chart.svg


def is_guessed(measured):
    """Where (n,) an `Albedo` is beyond the measured angles."""
    return measured.theta_i > measured.measured_to + 1


def _albedo(model, anisotropic):
    """The albedo (n,) of a model's luminance, at the angles of that of the measurement."""
    grey = SimpleNamespace(
        channels=("Y",),
        anisotropic=anisotropic,
        eval=lambda wi, wo: luminance(model.eval(wi, wo))[:, None],
    )
    return compute_albedo(grey, measured_to=90.0).values[:, 0]


def _step(most):
    """A step of ticks, 1, 2 or 5 times a power of ten, of which `most` has two to five."""
    power = 10 ** np.floor(np.log10(most))
    return power * (1 if most > 4 * power else 0.5 if most > 2 * power else 0.2)
