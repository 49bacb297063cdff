"""The values of a model's parameters as the state of a view keeps them: plain numbers by name.

A weight has the names NAME.R, NAME.G and NAME.B, a flag NAME.linked that lets all channels change
by one factor, and NAME.colour if the weight is a colour: its hue, as a picker shows it. A parameter
that follows another one, as alpha_v follows alpha_u, has a flag NAME.tied.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.model import Model
from brdfkit.viewing.controls import State
from brdfkit.viewing.volumes.transfer_table import format_colour, parse_colour

PREFIX = "model."  # of all names
CHANNELS = "R", "G", "B"


def to_state(model: Model) -> State:
    """Return the state of a model's values; channels are linked, and equal parameters are tied."""
    state: State = {}
    shown = model.rgb
    for name, parameter in shown.parameters.items():
        key, value = PREFIX + name, getattr(shown, name)
        if not parameter.linear:
            state[key] = value
            if parameter.follows:
                state[f"{key}.tied"] = value == getattr(shown, parameter.follows)
            continue
        _set_channels(state, key, np.broadcast_to(value, 3))
        state[f"{key}.linked"] = True
        if parameter.bounds[0] >= 0:
            state[f"{key}.colour"] = to_hue(_get_channels(state, key))
    return state


def to_model(model: type[Model], state: State) -> Model:
    """Return the model with the values of a state; raise `BrdfkitError` for one out of bounds."""
    values = {}
    for name, parameter in model.parameters.items():
        key = PREFIX + name
        values[name] = state[key] if not parameter.linear else _get_channels(state, key)
    return model(**values)


def change_values(model: type[Model], state: State, changes: Mapping[str, object]) -> State:
    """Return the state after changes of some names, which links and ties pass on to others."""
    new = state | dict(changes)
    for name, parameter in model.parameters.items():
        key = PREFIX + name
        if parameter.linear:
            _change_weight(state, new, key, changes)
        elif parameter.follows:
            if key in changes and f"{key}.tied" not in changes:
                new[f"{key}.tied"] = False
            if new[f"{key}.tied"]:
                new[key] = new[PREFIX + parameter.follows]
    return new


def _change_weight(before: State, new: State, key: str, changes: Mapping[str, object]) -> None:
    """Pass a change of a weight on to its other channels, if linked, and to its colour."""
    old = _get_channels(before, key)
    moved = [k for k, channel in enumerate(CHANNELS) if f"{key}.{channel}" in changes]
    if len(moved) == 1 and new[f"{key}.linked"]:
        value = float(_get_channels(new, key)[moved[0]])
        black = not old.any() and f"{key}.colour" in before
        hue = parse_colour(before[f"{key}.colour"]) if black else old
        _set_channels(new, key, _scale_to(hue, moved[0], value))
    if f"{key}.colour" in changes:
        hue = parse_colour(str(changes[f"{key}.colour"]))
        _set_channels(new, key, old.max() * hue / hue.max() if hue.any() else np.zeros(3))
    elif f"{key}.colour" in new and _get_channels(new, key).any():  # black keeps its hue
        new[f"{key}.colour"] = to_hue(_get_channels(new, key))


def _scale_to(channels: FloatArray, at: int, value: float) -> FloatArray:
    """Return channels times the factor that makes the one at an index `value`.

    All become `value` where no factor does.
    """
    if not channels[at]:
        return np.full(3, value)
    scaled = channels * (value / channels[at])
    scaled[channels == channels[at]] = value  # without rounding
    return scaled


def to_hue(channels: FloatArray) -> str:
    """Return linear channels as a colour such as "#ff8800", the brightest channel full.

    Black has the hue of white.
    """
    brightest = float(np.max(channels))
    shares = channels / brightest if brightest > 0 else np.ones(3)
    return format_colour(shares)


def _get_channels(state: State, key: str) -> FloatArray:
    """Return the three channels of a weight."""
    return np.array([state[f"{key}.{channel}"] for channel in CHANNELS], float)


def _set_channels(state: State, key: str, channels: FloatArray) -> None:
    """Set the three channels of a weight."""
    for channel, value in zip(CHANNELS, channels, strict=True):
        state[f"{key}.{channel}"] = float(value)
