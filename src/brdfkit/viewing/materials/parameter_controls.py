"""The controls of a model's parameters, as the model declares them, on a panel for each lobe."""

from __future__ import annotations

import re
from functools import partial
from typing import Any

import numpy as np

from brdfkit.model import Model, Parameter
from brdfkit.viewing.controls import Control
from brdfkit.viewing.materials.parameter_groups import group_parameters
from brdfkit.viewing.materials.parameter_state import CHANNELS, PREFIX, to_state

UNIT = re.compile(r" \[(\w+)\]$")  # at the end of a meaning
ROOM = 2.0  # a weight's slider goes to this many times its value, at least
STEPS = (1.0, 2.0, 5.0, 10.0)  # the ends of sliders, times a power of ten


def list_panels(model: type[Model]) -> list[tuple[str, str, bool]]:
    """Return the name, the label and whether it is open of each panel of a model's parameters."""
    return [
        (f"{PREFIX}{number}", group.label, number < 4)
        for number, group in enumerate(group_parameters(model))
    ]


def make_controls(model: Model) -> list[Control]:
    """Return the controls of a model's parameters, whose defaults are its values.

    A weight has a slider per channel, which reaches beyond its value, a link between the channels,
    and a colour unless it may be negative. A parameter that follows another one can be tied to it.
    """
    shown, state = model.rgb, to_state(model)
    controls = []
    for number, group in enumerate(group_parameters(type(model))):
        panel = f"{PREFIX}{number}"
        for name in (*group.weights, *group.shapes):
            parameter = shown.parameters[name]
            control = partial(_make_control, name, parameter, panel, state)
            if parameter.linear:
                controls += _make_weight_controls(control, parameter, getattr(shown, name))
                continue
            low, high = parameter.bounds
            controls.append(control("", low=low, high=high, log=parameter.log))
            if parameter.follows:
                other = read_meaning(parameter.follows, shown.parameters[parameter.follows])[0]
                controls.append(control(".tied", f"equal to {other}", kind="flag"))
    return controls


def _make_weight_controls(control: Any, parameter: Parameter, value: Any) -> list[Control]:
    """Return the controls of a weight with a value."""
    high = min(choose_end(parameter, float(np.max(np.abs(value)))), parameter.bounds[1])
    low = -high if parameter.bounds[0] < 0 else 0.0
    controls = [control(f".{c}", c, low=low, high=high) for c in CHANNELS]
    controls.append(control(".linked", "channels linked", kind="flag"))
    if parameter.bounds[0] >= 0:
        controls.append(control(".colour", "colour", kind="colour"))
    return controls


def _make_control(
    name: str,
    parameter: Parameter,
    panel: str,
    state: dict[str, Any],
    ending: str,
    what: str = "",
    **settings: Any,
) -> Control:
    """Return a control of a parameter; its name has an `ending`, its label says `what` it is."""
    key = f"{PREFIX}{name}{ending}"
    symbol, meaning, unit = read_meaning(name, parameter)
    label = f"{symbol} {what}".strip()
    unit = unit if settings.get("kind", "slider") == "slider" else ""
    return Control(key, label, panel, state[key], unit=unit, help=meaning, **settings)


def read_meaning(name: str, parameter: Parameter) -> tuple[str, str, str]:
    """Return the symbol, the meaning and the unit of a parameter, from what it declares.

    >>> read_meaning("alpha", shape(0.2, (0.001, 1), "m: rms slope [rad]"))    # doctest: +SKIP
    ('m', 'rms slope', 'rad')
    """
    found = UNIT.search(parameter.meaning)
    meaning = UNIT.sub("", parameter.meaning)
    symbol, colon, text = meaning.partition(": ")
    if not colon:
        symbol, text = name, meaning
    return symbol, text[:1].upper() + text[1:] + ".", found[1] if found else ""


def choose_end(parameter: Parameter, largest: float) -> float:
    """Return the end of a weight's slider, a round number, for channels of at most `largest`."""
    least = max(1.0, ROOM * abs(parameter.default or 0.0), ROOM * largest)
    power = 10.0 ** np.floor(np.log10(least))
    return float(next(step * power for step in STEPS if step * power >= least * (1 - 1e-9)))
