"""Numbers that no picture shows, and the weights of 0 that may hide them."""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.scenes.problem.scene_parameters import numbers_in


def nothing_seen(views):
    """The `BrdfkitError` for numbers on which no picture depends."""
    names = ", ".join(unknown.name for unknown in views.unknowns)
    zero = {name for unknown in views.unknowns for name in _hiding(views.parameters, unknown)}
    hidden = f"{', '.join(sorted(zero))} = 0 hides it, " if zero else ""
    return BrdfkitError(
        f"no picture changes with {names}: either {hidden}nothing of it is seen, or the integrator "
        "does not differentiate it."
    )


def notes_on_weights(views, certainty):
    """What weights that ended at 0 hide of the numbers that are not determined."""
    known = certainty.names
    hidden = [u for u in views.unknowns if not u.shape and not any(n in known for n in u.names)]
    zero = dict.fromkeys(name for u in hidden for name in _hiding(views.parameters, u))
    return tuple(
        f"{name} = 0 hides what it multiplies; begin above 0, or with more starts, to see it"
        for name in zero
    )


def _hiding(parameters, unknown):
    """The names of the weights of an unknown's model that are 0, which may hide what they multiply;
    none of a weight itself, and of no model's number."""
    if not unknown.model or unknown.linear:
        return []
    known = numbers_in(parameters, unknown.owner, unknown.model) or {}
    weights = [name for name in unknown.model.weights() if name in known]
    return [f"{unknown.owner}.{name}" for name in weights if not np.any(known[name])]
