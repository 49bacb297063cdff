"""The controls of the volume application: what the page shows beside the picture."""

from __future__ import annotations

from functools import partial
from typing import Any

from brdfkit.core.catalogue import list_environments
from brdfkit.viewing.controls import Control
from brdfkit.viewing.tone_controls import make_tone_controls
from brdfkit.viewing.volumes.live_scene import PHASES
from brdfkit.volumes import Volume

PANELS = (
    ("picture", "Picture", True),
    ("transfer", "Transfer function", True),
    ("light", "Light", False),
    ("tone", "Tone mapping", False),
    ("camera", "Camera", False),
    ("clip", "Clipping box", False),
    ("slices", "Slices", False),
)
LABELS = {
    "single_scattering": "Scattering (lit)",
    "emission_absorption": "Emission and absorption",
    "maximum_intensity": "Maximum intensity",
    "isosurface": "Isosurface",
}
SCATTERING = {"renderer": ("single_scattering",)}
SURFACE = {"renderer": ("isosurface",)}
LIT = {"renderer": ("single_scattering", "isosurface")}
MATTER = {"renderer": ("single_scattering", "emission_absorption", "maximum_intensity")}
DENSE = {"renderer": ("single_scattering", "emission_absorption")}
MODES = (
    ("preset", "the preset as it is"),
    ("points", "points over values"),
    ("bumps", "bumps over values"),
    ("bumps2d", "bumps over values and gradients"),
)


def make_controls(volume: Volume, level: float, distance: float, value_unit: str) -> list[Control]:
    """Return the controls for a volume, with its range of values and its size.

    `level` is the default value of the surface, `distance` that of the camera; `value_unit` is the
    unit of the volume's values.
    """
    low, high = volume.range
    values = {"low": low, "high": high, "unit": value_unit}
    return [
        *_picture_controls(level, values),
        *_transfer_controls(volume.labels),
        *_light_controls(),
        *make_tone_controls(),
        *_camera_controls(distance, volume.unit),
        *_slice_controls(volume.window, values),
    ]


def _picture_controls(level: float, values: dict[str, Any]) -> list[Control]:
    """Return the controls of the renderers; `level` is the default value of the surface."""
    control = partial(Control, panel="picture")
    renderers = tuple(LABELS.items())
    seconds = (("", "nothing"), *renderers)
    phases = tuple((name, name.replace("_", " ")) for name in PHASES)
    skewed = SCATTERING | {"phase": ("henyey_greenstein", "schlick")}
    more = "1 is single scattering; more is slower and brighter."
    forwards = "Above 0 light goes on forwards, below 0 it turns back."
    pixels = "Pixels of the picture for each pixel of the screen."
    first: dict[str, Any] = {"default": "single_scattering", "kind": "choice", "choices": renderers}
    phase: dict[str, Any] = {"default": "henyey_greenstein", "kind": "choice", "choices": phases}
    scales: dict[str, Any] = {"low": 0.125, "high": 1, "step": 0.125}
    return [
        control("renderer", "Renderer", **first),
        control("second", "Right of the wipe", default="", kind="choice", choices=seconds),
        control("wipe", "Wipe", default=0.5, when={"second": tuple(LABELS)}),
        control("level", "Surface's value", default=level, when=SURFACE, **values),
        control("surface.colour", "Surface", default="#ddcbbb", kind="colour", when=SURFACE),
        control("phase", "Phase function", **phase, when=SCATTERING),
        control(
            "asymmetry",
            "Asymmetry g",
            default=0.0,
            low=-0.95,
            high=0.95,
            when=skewed,
            help=forwards,
        ),
        control(
            "depth", "Scatterings", default=1, low=1, high=64, step=1, when=SCATTERING, help=more
        ),
        control("background", "Background", default="#262626", kind="colour"),
        control("show.environment", "Show environment", default=False, kind="flag", when=LIT),
        control("show.box", "Bounding box", default=True, kind="flag"),
        control("show.axes", "Axes", default=True, kind="flag"),
        control("view.scale", "Resolution", default=1.0, low=0.25, high=2, step=0.25, help=pixels),
        control("view.moving_scale", "Resolution while moving", default=0.5, **scales),
    ]


def _transfer_controls(labels: bool) -> list[Control]:
    """Return the controls beside the editor of the transfer function."""
    control = partial(Control, panel="transfer")
    factor: dict[str, Any] = {
        "low": 0.01,
        "high": 100,
        "log": True,
        "help": "A factor of the extinction.",
    }
    meanings = (("albedo", "what is scattered"), ("emission", "what glows"))
    colour: dict[str, Any] = {"default": "albedo", "kind": "choice", "choices": meanings}
    mode: dict[str, Any] = {"default": "points", "kind": "choice", "choices": MODES}
    nearest = (
        "Labels, such as numbers of tissues, have colours of their own, and no values between."
    )
    return [
        control("density", "Density", default=1.0, when=DENSE, **factor),
        control("transfer.mode", "Drawn by", when=MATTER, **mode),
        control("transfer.colour", "Colour is", when=SCATTERING, **colour),
        control("labels", "Values are labels", default=labels, kind="flag", help=nearest),
    ]


def _light_controls() -> list[Control]:
    """Return the controls of the light."""
    control = partial(Control, panel="light", when=LIT)
    maps = tuple((name, name) for name in list_environments())
    turn: dict[str, Any] = {"low": -180, "high": 180, "unit": "°"}
    environment: dict[str, Any] = {"default": "studio", "kind": "choice", "choices": maps}
    sun = partial(Control, panel="light", when=LIT | {"light.sun": (True,)})
    return [
        control("light.environment", "Environment", **environment),
        control("light.turn", "Rotation", default=0.0, **turn),
        control("light.brightness", "Brightness", default=1.0, low=0.01, high=10, log=True),
        control("light.sun", "Sun", default=False, kind="flag"),
        sun("light.sun_colour", "Sun's colour", default="#fff4e0", kind="colour"),
        sun("light.sun_strength", "Sun's strength", default=3.0, low=0, high=50),
        sun("light.sun_azimuth", "Sun's azimuth", default=-40.0, **turn),
        sun("light.sun_elevation", "Sun's elevation", default=45.0, low=-90, high=90, unit="°"),
    ]


def _camera_controls(distance: float, unit: str) -> list[Control]:
    """Return the controls of the camera, whose default is at a `distance` [unit]."""
    control = partial(Control, panel="camera")
    reach: dict[str, Any] = {"low": distance / 50, "high": distance * 10, "log": True, "unit": unit}
    return [
        control("camera.azimuth", "Azimuth", default=30.0, low=-360, high=360, unit="°"),
        control("camera.elevation", "Elevation", default=20.0, low=-90, high=90, unit="°"),
        control("camera.distance", "Distance", default=distance, **reach),
        control("camera.fov", "Field of view", default=25.0, low=2, high=120, unit="°"),
    ]


def _slice_controls(window: tuple[float, float], values: dict[str, Any]) -> list[Control]:
    """Return the controls of the slices, whose defaults are the ends of the `window`."""
    control = partial(Control, panel="slices")
    shown = values | {"when": {"show.slices": (True,)}}
    return [
        control("show.slices", "Show slices", default=False, kind="flag"),
        control("slices.low", "Black at", default=window[0], **shown),
        control("slices.high", "White at", default=window[1], **shown),
    ]
