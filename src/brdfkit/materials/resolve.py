"""Finds the material that a user means by an object, a name, a path or a dictionary.

A material is a measured one, a fit, or a model with values: all have a `name`, `eval(wi, wo)` and
`scene_dict()`. In its place every verb accepts a name or a path, in Python as on the command line:
the label of a model, which then has its defaults; a file that `load` reads; or the name of a
material that brdfkit knows. The dictionary of one of Mitsuba's BSDFs is a material, too.
"""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from brdfkit.core import catalogue
from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.locate import looks_like_name
from brdfkit.materials.loading import load
from brdfkit.materials.measured import Measured
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import BsdfMaterial
from brdfkit.model import labels


@runtime_checkable
class Material(Protocol):
    """The attributes that a `Measured`, a `Fit` and a `Model` with values have in common."""

    @property
    def name(self) -> str:
        """The name in pictures and tables."""

    def eval(self, wi: FloatArray, wo: FloatArray) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, channels) of direction pairs (n, 3)."""

    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary for `mitsuba.load_dict`."""


MaterialLike: TypeAlias = Material | str | Path | dict[str, Any]
ATTRIBUTES = "name", "eval", "scene_dict"


def to_material(thing: MaterialLike, needed: Iterable[str] = ATTRIBUTES) -> Material:
    """Return the material that `thing` is, or means as a name, a path or a dictionary.

    An object with the `needed` attributes is returned as it is. Raises `BrdfkitError`, the same one
    for every verb, for anything that is no material.

    >>> to_material("ward").alpha_u
    0.2
    """
    if isinstance(thing, str | Path):
        return _find(str(thing))
    if isinstance(thing, dict):
        return BsdfMaterial.from_dictionary(thing)
    if isinstance(thing, type) and hasattr(thing, "lobes"):
        name = thing.__name__
        raise BrdfkitError(f"{name} is a model without values; call it: {name}().")
    if not all(hasattr(thing, attribute) for attribute in needed):
        raise BrdfkitError(
            f"{_describe(thing)} is no material; give a measured one, a fit, a model with values, "
            "a BSDF's dictionary, or the name or path of one."
        )
    return thing


def to_materials(
    things: MaterialLike | Iterable[MaterialLike], needed: Iterable[str] = ATTRIBUTES
) -> list[Material]:
    """Return the material of each of `things`, as a list; one thing alone gives a list of one.

    Raises `BrdfkitError` where there is none.
    """
    if isinstance(things, str | dict) or not isinstance(things, Iterable):
        things = [things]
    materials = [to_material(thing, needed) for thing in things]
    if not materials:
        raise BrdfkitError("There is no material here; give at least one.")
    return materials


def to_measured(thing: MaterialLike) -> Measured:
    """Return the `Measured` that `thing` is or stands for; raise `BrdfkitError` for any other."""
    material = to_material(thing)
    if not isinstance(material, Measured):
        raise BrdfkitError(
            f"{material.name} was not measured; give a measured material, or its name or path."
        )
    return material


def _find(name: str) -> Material:
    """Return the material of a name.

    It is a model with this label, unless a file has the same name; otherwise the file's content or
    the known material.
    """
    label = labels.load_files(name)
    if labels.is_label(label) and (label != name or not os.path.isfile(name)):
        return labels.model(label)()
    try:
        return load(name)
    except BrdfkitError:
        if not looks_like_name(name):
            raise
    known = [*labels.models(), *catalogue.list_materials()]
    raise no_such_error("file, model or material", name, known)


def _describe(thing: object) -> str:
    """Return any object in one line: the beginning of its `repr`, and its type."""
    kind, words = type(thing).__name__, " ".join(repr(thing).split())
    return f"{words[:40]}{'…' if len(words) > 40 else ''} ({kind})"
