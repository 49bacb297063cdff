"""What is a material, for every verb that takes one.

A measured material, a fit, or a model with values: all have a `name`, `eval(wi, wo)` and
`scene_dict()`. The name or path of one stands for it, in Python as on the command line: a model by
its label, with its defaults; a file that `load` reads; a material that brdfkit knows. So does the
dictionary of a BSDF of Mitsuba's.
"""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from brdfkit.catalogue import shipped
from brdfkit.errors import BrdfkitError, no_such
from brdfkit.host.bsdf_material import BsdfMaterial
from brdfkit.loading import load
from brdfkit.measured import Measured
from brdfkit.model import labels


@runtime_checkable
class Material(Protocol):
    """What a `Measured`, a `Fit` and a `Model` with values have in common."""

    @property
    def name(self) -> str:
        """What pictures and tables call it."""

    def eval(self, wi: NDArray[np.float64], wo: NDArray[np.float64]) -> NDArray[np.float64]:
        """BRDF (n, channels) in sr⁻¹ of direction pairs (n, 3)."""

    def scene_dict(self) -> dict[str, Any]:
        """The dictionary for `mitsuba.load_dict`."""


MaterialLike: TypeAlias = Material | str | Path | dict[str, Any]
ATTRIBUTES = "name", "eval", "scene_dict"


def material(thing: MaterialLike, needed: Iterable[str] = ATTRIBUTES) -> Material:
    """`thing` itself, once it has the `needed` attributes, or what its name or path stands for.

    Raises `BrdfkitError`, one and the same for every verb, for what is no material.

    >>> material("ward").alpha_u
    0.2
    """
    if isinstance(thing, str | Path):
        return _named(str(thing))
    if isinstance(thing, dict):
        return BsdfMaterial.of(thing)
    if isinstance(thing, type) and hasattr(thing, "lobes"):
        name = thing.__name__
        raise BrdfkitError(f"{name} is a model without values; call it: {name}().")
    if not all(hasattr(thing, attribute) for attribute in needed):
        raise BrdfkitError(
            f"{_shown(thing)} is no material; give a measured one, a fit, a model with values, a "
            "BSDF's dictionary, or the name or path of one."
        )
    return thing


def materials(
    things: MaterialLike | Iterable[MaterialLike], needed: Iterable[str] = ATTRIBUTES
) -> list[Material]:
    """One material or several, as a list; at least one."""
    if isinstance(things, str | dict) or not isinstance(things, Iterable):
        things = [things]
    found = [material(thing, needed) for thing in things]
    if not found:
        raise BrdfkitError("There is no material here; give at least one.")
    return found


def measured(thing: MaterialLike) -> Measured:
    """A `Measured`, or what its name or path stands for; `BrdfkitError` for another material."""
    found = material(thing)
    if not isinstance(found, Measured):
        raise BrdfkitError(
            f"{found.name} was not measured; give a measured material, or the name or path of one."
        )
    return found


def _named(name: str) -> Material:
    """The material of a name: of a model, where no file bears it, else of a file or known name."""
    label = labels.read_files(name)
    if labels.is_label(label) and (label != name or not os.path.isfile(name)):
        return labels.model(label)()
    try:
        return load(name)
    except BrdfkitError:
        if not name or "/" in name or Path(name).suffix or os.path.exists(name):
            raise
    raise no_such("file, model or material", name, [*labels.models(), *shipped.materials()])


def _shown(thing: object) -> str:
    """In one line, whatever it is."""
    kind, words = type(thing).__name__, " ".join(repr(thing).split())
    return f"{words[:40]}{'…' if len(words) > 40 else ''} ({kind})"
