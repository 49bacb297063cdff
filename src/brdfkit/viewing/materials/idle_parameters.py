"""Finds the parameters of a model that do nothing at the moment, and says why."""

from __future__ import annotations

import numpy as np

from brdfkit.lighting.filtering.scene_bsdfs import PAIRS
from brdfkit.model import Model
from brdfkit.model.evaluation import compute_lobe_values
from brdfkit.viewing.materials.parameter_controls import read_meaning
from brdfkit.viewing.materials.parameter_groups import find_affected_lobes


def find_idle_parameters(model: Model) -> dict[str, str]:
    """Return why parameters do nothing with the present values of a model, by their names.

    A shape parameter does nothing where the weights of all lobes that depend on it are 0; nor does
    one that equals the parameter that it follows, until it differs. A weight does nothing where the
    shape parameters make its lobe 0.
    """
    kind = type(model)
    weights = kind.weights()
    black = np.array([not np.any(getattr(model, name)) for name in weights] + [False])
    idle = {}
    for name, affected in find_affected_lobes(kind).items():
        follows = kind.parameters[name].follows
        if not affected.any():
            idle[name] = "No term of the model depends on it."
        elif black[affected].all():
            symbols = [_find_symbol(kind, weights[k]) for k in np.flatnonzero(affected)]
            idle[name] = _join(symbols) + (" are 0." if len(symbols) > 1 else " is 0.")
        elif follows and getattr(model, name) == getattr(model, follows):
            idle[name] = f"It equals {_find_symbol(kind, follows)}: the material is isotropic."
    values = np.abs(np.concatenate(compute_lobe_values(model, *PAIRS)))
    for name, largest in zip(weights, values.max(axis=0), strict=True):
        if largest == 0:
            idle[name] = "The shape of the model makes this term 0."
    return idle


def _find_symbol(model: type[Model], name: str) -> str:
    """Return the symbol of a parameter."""
    return read_meaning(name, model.parameters[name])[0]


def _join(words: list[str]) -> str:
    """Join words to a text; of many, the first and the last."""
    if len(words) > 3:
        return f"{words[0]} to {words[-1]}"
    return " and ".join(words)
