"""Checks the values of a model's parameters that the page sends."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.model import Model
from brdfkit.viewing.controls import Control, State
from brdfkit.viewing.materials.parameter_controls import make_controls
from brdfkit.viewing.materials.parameter_state import CHANNELS, PREFIX, change_values

LARGEST_WEIGHT = 1e6


def check_values(model: Model, state: State, values: State) -> State:
    """Return a state after changes of values of a model; raise `BrdfkitError` for wrong ones.

    The names of the values are in the state. `model` has the values with which its controls begin.
    """
    controls = {control.name: control for control in make_controls(model)}
    checked = {
        name: _check_parameter(controls[name], type(model), value) for name, value in values.items()
    }
    return change_values(type(model), state, _without_colours(checked))


def _check_parameter(control: Control, model: type[Model], value: Any) -> Any:
    """Return the value of a parameter's control; a weight may be beyond the end of its slider."""
    name, _, ending = control.name.removeprefix(PREFIX).partition(".")
    if ending in CHANNELS:
        low, high = np.clip(model.parameters[name].bounds, -LARGEST_WEIGHT, LARGEST_WEIGHT)
        control = replace(control, low=float(low), high=float(high))
    return control.check(value)


def _without_colours(values: State) -> State:
    """Return values without the colours of weights whose channels are given, which say more."""
    given = {name.rpartition(".")[0] for name in values if name.rpartition(".")[2] in CHANNELS}
    return {
        name: value
        for name, value in values.items()
        if not (name.endswith(".colour") and name.rpartition(".")[0] in given)
    }
