"""The properties that a plugin is given in a scene: checked, and brought to what Mitsuba holds."""

import os

import numpy as np

from brdfkit.errors import BrdfkitError


def require_within_bounds(props, model, name):
    """An error for a constant parameter out of bounds; textures are taken as they are."""
    value = props.get(name, None)
    if isinstance(value, float | int) or is_colour(value):
        problem = model.parameters[name].problem_with(np.array(value, float))
        if problem:
            raise BrdfkitError(f"{model.type_name()}: {name} = {problem}.")


def fit_for_a_spectrum(props, model, name):
    """Bring a colour to 0..1, beyond which Mitsuba clips its spectrum without a word; the scale."""
    value = props[name]
    if min(value) < 0:
        raise BrdfkitError(
            f"{model.type_name()}: {name} is a colour with a value below 0, which no spectrum "
            "holds; use an rgb or mono variant of Mitsuba."
        )
    scale = 2 * max(value) if max(value) > 1 else 1
    props[name] = value / scale
    return scale


def is_colour(value):
    return type(value).__name__.endswith("Color3d")


def located(name):
    """The file of that name as the scene finds it, beside its own; other names as they are."""
    import mitsuba as mi

    file, hash_sign, sample = name.rpartition("#")
    for path, rest in ((name, ""), (file, hash_sign + sample)):
        found = str(mi.file_resolver().resolve(path))
        if os.path.isfile(found):
            return found + rest
    return name
