"""`list_curves`: the materials that all plots of a view show, each with its colour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias
from weakref import WeakKeyDictionary

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.spectrum_to_rgb import to_rgb_or_mean
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.picture_controls import MEASURED
from brdfkit.viewing.materials.pins import find_colour, label_pin, make_model, name_pin

States: TypeAlias = Any  # `MaterialState`, which imports the controls of the plots

# Colours that colour-blind people can tell from each other and from those of pins
MEASURED_COLOUR, MODEL_COLOUR = "#e09a00", "#009e73"
_MEANS: WeakKeyDictionary[Measured, Measured] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Curve:
    """A material in the plots.

    `name`: its name in legends; `colour`: its colour, such as "#e09a00"; `material`: the material,
    in linear sRGB or with one channel. `twin`: whether it is a pin with the values of the shown
    model, whose curve lies exactly over that one.
    """

    name: str
    colour: str
    material: Any
    twin: bool = False

    @property
    def is_measured(self) -> bool:
        """Whether the material was measured, so that parts of it are unknown."""
        return isinstance(self.material, Measured)


def list_curves(states: States, state: State) -> list[Curve]:
    """Return what the plots show: the material of the view, the model of the sliders, and pins.

    A pin that is alone takes the place of all models.
    """
    curves = []
    if states.measured is not None:
        _, measured = states.find_side(state, MEASURED)
        curves.append(Curve(states.name, MEASURED_COLOUR, to_shown(measured)))
    pins = [pin for pin in state["pins"] if state["solo"] in ("", name_pin(pin))]
    shown = None if state["solo"] else states.to_model(state)
    if shown is not None:
        curves.append(Curve(state["model"], MODEL_COLOUR, shown))
    for pin in pins:
        model = make_model(states, pin)
        curves.append(Curve(label_pin(pin), find_colour(pin), model, twin=model == shown))
    return curves


def to_shown(material: Any) -> Any:
    """Return a material in linear sRGB, or the mean of channels that have no colour."""
    if not isinstance(material, Measured):
        return getattr(material, "rgb", material)
    try:
        return material.rgb
    except BrdfkitError:
        if material not in _MEANS:
            _MEANS[material] = to_rgb_or_mean(material)
        return _MEANS[material]
