"""The controls of the picture of a material: what it shows, from where, and in which light."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any

from brdfkit.core.catalogue import list_environments
from brdfkit.rendering.scenes import scene_names
from brdfkit.viewing.controls import Control
from brdfkit.viewing.materials.live_light import LAMP
from brdfkit.viewing.materials.material_scene import (
    LAMP_AZIMUTH,
    LAMP_ELEVATION,
    PLANE,
    make_studio_camera,
)

# What can be left and right of the wipe; the file is what it says while something of it is mended
MEASURED, FILE, MODEL = "measured", "file", "model"
WITHOUT_SKY = ("cornell_box",)  # scenes that an environment cannot light
COMPARISONS = (
    ("wipe", "wipe"),
    ("flicker", "flicker: in turn"),
    ("difference", "ΔE map"),
    ("beside", "side by side"),
)
COMPARISON_HELP = (
    "How both sides are seen; ΔE is the difference in colour, of which 1 is just visible."
)


def make_picture_controls(
    measured: Sequence[tuple[str, str]],
    label: str,
    pins: Sequence[tuple[str, str]],
    meshes: Iterable[str] = (),
) -> list[Control]:
    """Return the controls of what is shown, and from where; `meshes` are the user's own."""
    control = partial(Control, panel="picture")
    shown = *measured, (MODEL, label), *pins
    first, second = (MEASURED, MODEL) if measured else (MODEL, "")
    right: dict[str, Any] = {"default": second, "choices": (("", "nothing"), *shown)}
    two = {"second": tuple(name for name, _ in shown)}
    ways: dict[str, Any] = {"default": "wipe", "choices": COMPARISONS, "help": COMPARISON_HELP}
    pixels = "Pixels of the picture for each pixel of the screen."
    scales: dict[str, Any] = {"low": 0.125, "high": 1, "step": 0.125}
    others = [name for name in scene_names() if name not in ("ball", *WITHOUT_SKY)]
    shapes = tuple((name, name.replace("_", " ")) for name in ("ball", PLANE, *others))
    shapes += tuple((name, _label_mesh(name)) for name in meshes)
    camera = make_studio_camera()
    return [
        # The page calls "renderer" what is left of the wipe
        control("renderer", "Left of the wipe", default=first, kind="choice", choices=shown),
        control("second", "Right of the wipe", kind="choice", **right),
        control("compare", "Compare", kind="choice", when=two, **ways),
        control("wipe", "Wipe", default=0.5, when={**two, "compare": ("wipe",)}),
        # The list of pins shows it
        control("solo", "Solo", panel="", default="", kind="choice", choices=(("", "all"), *pins)),
        control("shape", "Shape", default="ball", kind="choice", choices=shapes),
        make_angle("view.azimuth", "View, around", camera.azimuth, 180, panel="picture"),
        make_angle("view.elevation", "View, above", camera.elevation, 89, panel="picture"),
        *([make_unmeasured_control()] if measured else []),
        control("view.scale", "Resolution", default=1.0, low=0.25, high=2, step=0.25, help=pixels),
        control("view.moving_scale", "Resolution while moving", default=0.5, **scales),
    ]


def make_unmeasured_control() -> Control:
    """Return the control that hatches what was not measured."""
    meaning = (
        "Stripes where the lamp and the view, or most of an environment's light for the view, are "
        "beyond what was measured. Of a completed material, stripes are sparse where they were "
        "inferred, and dense where they are guesses."
    )
    label = "hatch what was not measured"
    return Control("show.unmeasured", label, "picture", False, kind="flag", help=meaning)


def _label_mesh(name: str) -> str:
    """Return the label of a mesh, whose name may end with the axis that points up."""
    file, _, up = name.rpartition("#")
    return f"{file}, {up} up" if file else name


def make_light_controls(maps: Iterable[str] = ()) -> list[Control]:
    """Return the controls of the light; `maps` are the user's own environments."""
    known = tuple(list_environments())
    choices = (*((name, name) for name in (*known, *maps)), (LAMP, "a lamp"))
    lamp, others = ({"light.environment": names} for names in ((LAMP,), (*known, *maps)))
    return [
        Control("light.environment", "Light", "light", "studio", kind="choice", choices=choices),
        make_angle("light.turn", "Rotation", 0.0, 180, when=others),
        make_angle("light.lamp_azimuth", "Lamp, around", LAMP_AZIMUTH, 180, when=lamp),
        make_angle("light.lamp_elevation", "Lamp, above", LAMP_ELEVATION, 90, when=lamp),
    ]


def make_angle(
    name: str, label: str, default: float, most: float, panel: str = "light", **options: Any
) -> Control:
    """Return the control of an angle between -`most` and `most` [degrees]."""
    return Control(name, label, panel, default, low=-most, high=most, unit="°", **options)
