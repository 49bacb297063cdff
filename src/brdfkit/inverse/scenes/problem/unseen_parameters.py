"""Explains why the pictures do not depend on a parameter: often a lobe's weight is 0."""

from collections.abc import Collection

import numpy as np

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.scenes.problem.parameters import Unknown
from brdfkit.inverse.scenes.problem.scene_parameters import read_model_values
from brdfkit.inverse.scenes.problem.views import Views


def make_no_effect_error(views: Views) -> BrdfkitError:
    """Return the error for searched parameters that have no effect on any picture."""
    names = ", ".join(unknown.name for unknown in views.unknowns)
    zero = {name for u in views.unknowns for name in _find_zero_weights(views.parameters, u)}
    hidden = f"{', '.join(sorted(zero))} = 0 hides it, " if zero else ""
    return BrdfkitError(
        f"no picture changes with {names}: either {hidden}it is not in view, or the integrator "
        "does not differentiate it."
    )


def describe_zero_weights(views: Views, determined: Collection[str]) -> tuple[str, ...]:
    """Return a sentence for each weight that ended at 0 and hides parameters of its lobe.

    `determined` holds the names of the numbers that the pictures determine.
    """
    hidden = [
        u for u in views.unknowns if not u.shape and not any(n in determined for n in u.names)
    ]
    zero = dict.fromkeys(name for u in hidden for name in _find_zero_weights(views.parameters, u))
    return tuple(
        f"{name} = 0 hides what it multiplies; to find it, begin above 0, or with more starts"
        for name in zero
    )


def _find_zero_weights(parameters: MitsubaObject, unknown: Unknown) -> list[str]:
    """Return the names of lobe weights that are 0 in the BSDF of an unknown shape parameter.

    A weight of 0 hides the shape parameters of its lobe. The list is empty if the unknown itself is
    a weight, or belongs to no model of brdfkit.
    """
    if not unknown.model or unknown.is_linear:
        return []
    values = read_model_values(parameters, unknown.owner, unknown.model) or {}
    weights = [name for name in unknown.model.weights() if name in values]
    return [f"{unknown.owner}.{name}" for name in weights if not np.any(values[name])]
