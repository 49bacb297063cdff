"""Checks and converts the properties that a scene gives to a plugin."""

import os
from collections.abc import Iterable
from typing import Any

import numpy as np

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.model import Model


def require_known_properties(props: MitsubaObject, plugin: str, known: Iterable[str]) -> None:
    """Raise `BrdfkitError` for a property that a new `plugin` has not read, such as a misspelt one.

    `known` are the names of the plugin's parameters. Mitsuba's own error would print each unread
    property in full, even a large object.
    """
    unknown = props.unqueried()
    if unknown:
        raise no_such_error("parameter", unknown[0], known, plugin)


def require_within_bounds(props: MitsubaObject, model: type[Model], name: str) -> None:
    """Raise `BrdfkitError` for a constant parameter out of bounds; textures are not checked."""
    value = props.get(name, None)
    if isinstance(value, float | int) or is_colour(value):
        problem = model.parameters[name].find_problem(np.array(value, float))
        if problem:
            raise BrdfkitError(f"{model.type_name()}: {name} = {problem}.")


def normalise_colour(props: MitsubaObject, model: type[Model], name: str) -> float:
    """Divide a colour in `props` by a scale that brings it into 0..1, and return the scale.

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


def is_colour(value: object) -> bool:
    """Return whether a property's value is a colour of Mitsuba."""
    return type(value).__name__.endswith("Color3d")


def resolve_file(name: str) -> str:
    """Return the path of a file that a scene names, which may lie beside the scene's file.

    The name may end with ``#SAMPLE``. A name of no file is returned as it is.
    """
    import mitsuba as mi

    file_resolver: Any = mi.file_resolver
    file, hash_sign, sample = name.rpartition("#")
    for path, suffix in ((name, ""), (file, hash_sign + sample)):
        resolved = str(file_resolver().resolve(path))
        if os.path.isfile(resolved):
            return resolved + suffix
    return name
