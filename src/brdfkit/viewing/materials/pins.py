"""Pins of a view: models whose values stay as they are, each with a number and a colour.

The state has them under "pins", as a list of {"number", "model", "values", "loss"}: "model" is a
label, "values" are its values as the state of a view has them, and "loss" is that of the fit which
they are, or "". A pin's name, such as "pin2", stands for it on a side of the wipe. "solo" is the
name of the pin that is alone in plots, or "".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from brdfkit.core.errors import BrdfkitError
from brdfkit.model import Model
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.parameter_checks import check_values
from brdfkit.viewing.materials.parameter_state import PREFIX, to_model, to_state
from brdfkit.viewing.materials.picture_controls import MODEL

States: TypeAlias = Any  # `MaterialState`, which imports this file

# By number: different from each other also for the colour-blind, on white and on black
COLOURS = "#cc4fa0", "#6622ff", "#889988", "#bb0033", "#0072b2", "#33aacc", "#446677", "#6677ff"
PIN = "pin"  # before the number of a pin in its name
KEYS = {"number", "model", "values", "loss"}
NONE: State = {"pins": [], "solo": ""}  # the state without pins


def find_pin(pins: Sequence[Mapping[str, Any]], name: str) -> Mapping[str, Any] | None:
    """Return the pin with a name, such as "pin2"; None if there is none."""
    return next((pin for pin in pins if name_pin(pin) == name), None)


def name_pin(pin: Mapping[str, Any]) -> str:
    """Return the name that stands for a pin in the state."""
    return f"{PIN}{pin['number']}"


def label_pin(pin: Mapping[str, Any]) -> str:
    """Return what people read for a pin."""
    return f"{pin['number']}: {pin['model']}"


def find_colour(pin: Mapping[str, Any]) -> str:
    """Return the colour of a pin."""
    return COLOURS[pin["number"] - 1]


def make_model(states: States, pin: Mapping[str, Any]) -> Model:
    """Return the model of a pin, with its values."""
    kind: type[Model] = type(states.find_model(pin["model"]))
    return to_model(kind, pin["values"])


def add_pin(pins: Sequence[Any], label: str, values: State, loss: str) -> list[Any]:
    """Return the pins with one more; the same values are pinned only once.

    Raises `BrdfkitError` where there is no colour left.
    """
    if any(pin["model"] == label and pin["values"] == values for pin in pins):
        return list(pins)
    taken = {pin["number"] for pin in pins}
    free = [number for number in range(1, len(COLOURS) + 1) if number not in taken]
    if not free:
        raise BrdfkitError(f"There are {len(COLOURS)} pins already; remove one first.")
    pin = {"number": free[0], "model": label, "values": values, "loss": loss}
    return sorted([*pins, pin], key=lambda own: own["number"])


def select_values(state: State) -> State:
    """Return the values of the model of a state."""
    return {name: value for name, value in state.items() if name.startswith(PREFIX)}


def has_values(fit: Any, values: State) -> bool:
    """Return whether values, as a state has them, are those of a fit."""
    fitted = to_state(fit.rgb)
    return all(values[name] == value for name, value in fitted.items() if _is_number(name))


def _is_number(name: str) -> bool:
    """Return whether the name of a value is that of a number, and not of a link or a colour."""
    return not name.endswith((".linked", ".tied", ".colour"))


def check_pins(states: States, pins: Any) -> list[Any]:
    """Return the pins that a page or an address gives; raise `BrdfkitError` for others."""
    if not isinstance(pins, list) or len(pins) > len(COLOURS):
        raise BrdfkitError(f"The pins should be a list of at most {len(COLOURS)}.")
    checked = [_check_pin(states, pin) for pin in pins]
    if len({pin["number"] for pin in checked}) < len(checked):
        raise BrdfkitError("Two pins have the same number.")
    return checked


def _check_pin(states: States, pin: Any) -> dict[str, Any]:
    """Return a pin whose values are possible; raise `BrdfkitError` for another one."""
    if not isinstance(pin, dict) or pin.keys() != KEYS or not isinstance(pin["values"], dict):
        raise BrdfkitError(f"A pin should have {', '.join(sorted(KEYS))}, and no more.")
    number, loss = pin["number"], pin["loss"]
    if number not in range(1, len(COLOURS) + 1) or not isinstance(loss, str) or len(loss) > 40:
        raise BrdfkitError(f"A pin's number should be 1 to {len(COLOURS)}, and its loss a name.")
    label: str = states.check_label(pin["model"])
    values = to_state(states.find_model(label))
    if values.keys() != pin["values"].keys():
        raise BrdfkitError(f"Pin {number} has other parameters than {label}.")
    values = check_values(states.find_model(label), values, pin["values"])
    return {"number": int(number), "model": label, "values": values, "loss": loss}


def forget_missing_pins(state: State) -> State:
    """Return the state in which no side and no plot shows a pin that is not there any more."""
    known = {name_pin(pin) for pin in state["pins"]}
    gone = {
        name: "" if name == "solo" else MODEL
        for name in ("renderer", "second", "solo")
        if state[name].startswith(PIN) and state[name] not in known
    }
    return state | gone
