"""Finds the material that a user means by an object, a name, a path or a dictionary.

A material is a `Measured`, a `Fit`, or a `Model` with parameter values. Public functions and
commands also accept other descriptions of one: the label of a model, such as "ward", which stands
for the model with its default values; the path of a file that `load` reads; the name of a material
that brdfkit knows; or the dictionary of a Mitsuba BSDF.
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
    """The interface of every material: of `Measured`, `Fit`, and `Model` with parameter values."""

    @property
    def name(self) -> str:
        """The material's name in pictures and tables."""

    def eval(self, wi: FloatArray, wo: FloatArray) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, channels) for directions to light and viewer, (n, 3) each."""

    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary from which `mitsuba.load_dict` makes the material's BSDF."""


MaterialLike: TypeAlias = Material | str | Path | dict[str, Any]
ATTRIBUTES = "name", "eval", "scene_dict"


def to_material(thing: MaterialLike, needed: Iterable[str] = ATTRIBUTES) -> Material:
    """Return the material that `thing` is, or that it describes by a name, path or dictionary.

    An object that has the `needed` attributes is returned unchanged. Raises `BrdfkitError` for
    anything that neither is nor describes a material.

    >>> to_material("ward").alpha_u
    0.2
    """
    if isinstance(thing, str | Path):
        return _find_material(str(thing))
    if isinstance(thing, dict):
        return BsdfMaterial.from_dictionary(thing)
    if isinstance(thing, type) and hasattr(thing, "lobes"):
        name = thing.__name__
        raise BrdfkitError(f"{name} is a model without values; call it: {name}().")
    if not all(hasattr(thing, attribute) for attribute in needed):
        raise BrdfkitError(
            f"{_describe_object(thing)} is no material; give a measured one, a fit, a model with "
            "values, a BSDF's dictionary, or the name or path of one."
        )
    return thing


def to_materials(
    things: MaterialLike | Iterable[MaterialLike], needed: Iterable[str] = ATTRIBUTES
) -> list[Material]:
    """Return a list with the material that each of `things` is or describes, by `to_material`.

    A single thing gives a list of one material. Raises `BrdfkitError` for an empty iterable.
    """
    if isinstance(things, str | dict) or not isinstance(things, Iterable):
        things = [things]
    materials = [to_material(thing, needed) for thing in things]
    if not materials:
        raise BrdfkitError("No material was given; give at least one.")
    return materials


def to_measured(thing: MaterialLike) -> Measured:
    """Return the `Measured` that `thing` is or names; raise `BrdfkitError` for a fit or a model."""
    material = to_material(thing)
    if not isinstance(material, Measured):
        raise BrdfkitError(
            f"{material.name} was not measured; give a measured material, or its name or path."
        )
    return material


def _find_material(name: str) -> Material:
    """Return the material that a model's label, a file's path or a material's name stands for.

    Where a label is also the name of a file, the file is meant.
    """
    label = labels.load_files_in_label(name)
    if labels.is_label(label) and (label != name or not os.path.isfile(name)):
        return labels.model(label)()
    try:
        return load(name)
    except BrdfkitError:
        if not looks_like_name(name):
            raise
    known = [*labels.models(), *catalogue.list_materials()]
    raise no_such_error("file, model or material", name, known)


def _describe_object(thing: object) -> str:
    """Return one line that shows any object in an error: the start of its `repr`, and its type."""
    kind, words = type(thing).__name__, " ".join(repr(thing).split())
    return f"{words[:40]}{'…' if len(words) > 40 else ''} ({kind})"
