"""The controls of a view of a material, besides those of a model's parameters."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from brdfkit.core.catalogue import list_environments
from brdfkit.model import labels
from brdfkit.viewing.controls import Control
from brdfkit.viewing.materials.about import describe_label
from brdfkit.viewing.materials.fit_settings import make_fit_controls
from brdfkit.viewing.materials.live_light import LAMP
from brdfkit.viewing.materials.material_scene import PLANE
from brdfkit.viewing.tone_controls import make_tone_controls

# What can be left and right of the wipe; the file is what it says while something of it is mended
MEASURED, FILE, MODEL = "measured", "file", "model"
NO_MODELS = ("mixture",)  # names that make no model by themselves
SHAPES = (("ball", "ball"), (PLANE, "plane"))

COMPARISONS = (
    ("wipe", "wipe"),
    ("flicker", "flicker: in turn"),
    ("difference", "ΔE map"),
    ("beside", "side by side"),
)
COMPARISON_HELP = (
    "How both sides are seen; ΔE is the difference in colour, of which 1 is just visible."
)


def make_explorer_controls(
    measured: Sequence[tuple[str, str]],
    models: Sequence[str],
    label: str,
    pins: Sequence[tuple[str, str]] = (),
) -> list[Control]:
    """Return the controls of a view of a material.

    `measured` are names and labels of what shows it; none where a model is shown alone. `models`
    are the labels that were used so far, and come first in the menu; `label` is that of the model
    that is shown. `pins` are names and labels of pins.
    """
    return [
        *_make_fit_controls(models, label, bool(measured)),
        *_make_picture_controls(measured, label, pins),
        *_make_light_controls(),
        *make_tone_controls(),
    ]


def _make_fit_controls(models: Sequence[str], label: str, compared: bool) -> list[Control]:
    """Return the controls of the model and of its fit."""
    others = [name for name in labels.models() if name not in (*models, *NO_MODELS)]
    known = tuple((name, describe_label(name)) for name in (*models, *others))
    sums = "A model, or a sum such as ggx+ward: type to search."
    control = partial(Control, panel="fit")
    model = control("model", "Model", default=label, kind="text", choices=known, help=sums)
    return [model, *(make_fit_controls() if compared else [])]


def _make_picture_controls(
    measured: Sequence[tuple[str, str]], label: str, pins: Sequence[tuple[str, str]]
) -> list[Control]:
    """Return the controls of what is shown, and where."""
    control = partial(Control, panel="picture")
    shown = *measured, (MODEL, label), *pins
    first, second = (MEASURED, MODEL) if measured else (MODEL, "")
    right: dict[str, Any] = {"default": second, "choices": (("", "nothing"), *shown)}
    two = {"second": tuple(name for name, _ in shown)}
    ways: dict[str, Any] = {"default": "wipe", "choices": COMPARISONS, "help": COMPARISON_HELP}
    pixels = "Pixels of the picture for each pixel of the screen."
    scales: dict[str, Any] = {"low": 0.125, "high": 1, "step": 0.125}
    return [
        # The page calls "renderer" what is left of the wipe
        control("renderer", "Left of the wipe", default=first, kind="choice", choices=shown),
        control("second", "Right of the wipe", kind="choice", **right),
        control("compare", "Compare", kind="choice", when=two, **ways),
        control("wipe", "Wipe", default=0.5, when={**two, "compare": ("wipe",)}),
        # The list of pins shows it
        control("solo", "Solo", panel="", default="", kind="choice", choices=(("", "all"), *pins)),
        control("shape", "Shape", default="ball", kind="choice", choices=SHAPES),
        control("view.scale", "Resolution", default=1.0, low=0.25, high=2, step=0.25, help=pixels),
        control("view.moving_scale", "Resolution while moving", default=0.5, **scales),
    ]


def _make_light_controls() -> list[Control]:
    """Return the controls of the light."""
    control = partial(Control, panel="light")
    maps = (*((name, name) for name in list_environments()), (LAMP, "a lamp"))
    turn: dict[str, Any] = {"low": -180, "high": 180, "unit": "°"}
    return [
        control("light.environment", "Environment", default="studio", kind="choice", choices=maps),
        control("light.turn", "Rotation", default=0.0, **turn),
    ]
