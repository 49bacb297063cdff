"""Checks and converts the properties that a scene gives to a plugin."""

import os

import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such


def require_known(props, plugin, known):
    """Raise `BrdfkitError` for a property that the `plugin`, which was made, has not asked for.

    Mitsuba would print all such properties, objects with all that is in them. known : the names of
    the plugin's own parameters.
    """
    unknown = props.unqueried()
    if unknown:
        raise no_such("parameter", unknown[0], known, plugin)


def require_within_bounds(props, model, name):
    """Raise `BrdfkitError` for a constant parameter out of bounds; textures are not checked."""
    value = props.get(name, None)
    if isinstance(value, float | int) or is_colour(value):
        problem = model.parameters[name].find_problem(np.array(value, float))
        if problem:
            raise BrdfkitError(f"{model.type_name()}: {name} = {problem}.")


def normalise_colour(props, model, name):
    """Divide a colour in `props` by a scale that brings it into 0..1; return the scale.

    Mitsuba clips the spectrum of a larger colour without a warning. Raises `BrdfkitError` for a
    colour with a value below 0.
    """
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
    """Whether a property is a colour of Mitsuba's."""
    return type(value).__name__.endswith("Color3d")


def resolve_file(name):
    """The path of the file `name`, possibly with ``#SAMPLE``, also if it lies beside the scene's.

    A name of no file comes back as it is.
    """
    import mitsuba as mi

    file, hash_sign, sample = name.rpartition("#")
    for path, rest in ((name, ""), (file, hash_sign + sample)):
        resolved = str(mi.file_resolver().resolve(path))
        if os.path.isfile(resolved):
            return resolved + rest
    return name
