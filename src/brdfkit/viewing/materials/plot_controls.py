"""The controls of the plots on a material's page: which are open, and what all of them show."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

from brdfkit.core.arguments import is_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.controls import Control
from brdfkit.viewing.materials.plots.settings import PREFIX

# Coordinates of what is selected
SELECTED = "theta_i", "theta_o", "theta_h", "theta_d", "view", "plane", "phi_i", "value"
# Name, label on its button, and help of each plot
PLOTS = (
    ("polar", "Lobes", "The BRDF over the angle of view, for one direction of the light."),
    ("lobe", "3-D", "The BRDF over all directions of view, as a surface that a drag turns."),
    (
        "slices",
        "Slices",
        "The BRDF over θh, the half vector's angle to the normal, and θd, the light's angle to "
        "the half vector: data, model, and model / data.",
    ),
    ("albedo", "Albedo", "The share of the light that is reflected, over the angle of incidence."),
    ("samples", "Samples", "Measured values as points, coloured by the model's ratio to them."),
)
OPEN_FIRST = ("polar",)
CHANNELS = (
    ("luminance", "luminance"),
    ("each", "R, G and B"),
    ("R", "R"),
    ("G", "G"),
    ("B", "B"),
)
OVER = (("theta_h", "θh"), ("theta_o", "θo"))
ANGLE = "θh is the half vector's angle to the normal, θo the angle of view."
SCALES = (("linear", "linear"), ("log", "log"), ("cbrt", "cube root"))


def make_plot_controls(anisotropic: bool) -> list[Control]:
    """Return the controls of the plots, without that of the azimuth unless `anisotropic`."""
    lobes: dict[str, Any] = {"when": {f"{PREFIX}show.polar": (True,)}}
    control = partial(make_control, panel="plots")
    angle: dict[str, Any] = {"unit": "°", "low": 0.0}
    shows = [
        control(f"show.{name}", label, default=name in OPEN_FIRST, kind="flag", help=text)
        for name, label, text in PLOTS
    ]
    azimuth: dict[str, Any] = {} if anisotropic else {"when": {"": (True,)}}  # which never holds
    return [
        *shows,
        control(
            "theta_i",
            "θi",
            default=45.0,
            high=89.0,
            help="Angle of the incident light to the normal. It is also dragged in the plots.",
            **angle,
        ),
        control(
            "phi_i",
            "φi",
            default=0.0,
            high=360.0,
            help="Azimuth of the incident light, which matters for an anisotropic material.",
            **angle,
            **azimuth,
        ),
        control(
            "channel",
            "Channel",
            default="luminance",
            kind="choice",
            choices=CHANNELS,
            help="What of the colour is plotted.",
        ),
        control(
            "scale",
            "Scale",
            default="cbrt",
            kind="choice",
            choices=SCALES,
            help="How far from the centre a value is drawn: cube root and log show dark parts too.",
        ),
        control("cosine", "× cos θo", default=False, kind="flag", help=COSINE),
        control("phi_o", "Plane", default=0.0, high=180.0, help=PLANE, **angle, **lobes),
        control("phi_d", "φd", default=90.0, high=180.0, help=PHI_D, **angle),
        control("samples_over", "over", default="theta_h", kind="choice", choices=OVER, help=ANGLE),
        SelectionControl(PREFIX + "selection", "Selection", "plots", [], "selection"),
        control("sampler", "Sampler", default=False, kind="flag", help=SAMPLER, **lobes),
    ]


class SelectionControl(Control):
    """What is selected in the plots: ranges [name, low, high], as a list; the page draws it."""

    def check(self, value: Any) -> Any:
        """Return the ranges; raise `BrdfkitError` for what are none."""
        if not isinstance(value, list) or not all(map(_is_range, value)):
            raise BrdfkitError("A selection should be a list of ranges [name, low, high].")
        return [[name, float(low), float(high)] for name, low, high in value]


def _is_range(value: Any) -> bool:
    """Return whether a value is a range [name, low, high] of a coordinate."""
    if not isinstance(value, list) or len(value) != 3 or value[0] not in SELECTED:
        return False
    return all(is_number(number) and math.isfinite(number) for number in value[1:])


def make_control(name: str, label: str, **settings: Any) -> Control:
    """Return a control of the plots."""
    return Control(PREFIX + name, label, **settings)


COSINE = "Multiply the BRDF by the cosine of the angle of view: the light that leaves a surface."
PLANE = "Angle between the plane of the views and that of the light: 0° is the plane of incidence."
PHI_D = (
    "Azimuth of the light around the half vector: 90° is across the plane of incidence, 0° in it."
)
SAMPLER = (
    "Density of the renderer's samples times the albedo, dotted, beside BRDF × cos θo. Where both "
    "are equal, the sampling adds no noise."
)
