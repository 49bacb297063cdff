"""What is a material, for every verb that takes one.

A measured material, a fit, or a model with values: all have a `name`, `eval(wi, wo)` and
`scene_dict()`. The name or path of one stands for it, in Python as on the command line: a model by
its label, with its defaults; a file that `load` reads; a material that brdfkit knows. So does the
dictionary of a BSDF of Mitsuba's.
"""

import os
from pathlib import Path

from brdfkit.catalogue import shipped
from brdfkit.errors import BrdfkitError, no_such
from brdfkit.host.bsdf_material import BsdfMaterial
from brdfkit.loading import load
from brdfkit.measured import Measured
from brdfkit.model import labels

ATTRIBUTES = "name", "eval", "scene_dict"


def material(thing, needed=ATTRIBUTES):
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


def materials(things, needed=ATTRIBUTES):
    """One material or several, as a list; at least one."""
    several = hasattr(things, "__iter__") and not isinstance(things, str | dict)
    found = [material(thing, needed) for thing in (things if several else [things])]
    if not found:
        raise BrdfkitError("There is no material here; give at least one.")
    return found


def measured(thing):
    """A `Measured`, or what its name or path stands for; `BrdfkitError` for another material."""
    found = material(thing)
    if not isinstance(found, Measured):
        raise BrdfkitError(
            f"{found.name} was not measured; give a measured material, or the name or path of one."
        )
    return found


def _named(name):
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


def _shown(thing):
    """In one line, whatever it is."""
    kind, words = type(thing).__name__, " ".join(repr(thing).split())
    return f"{words[:40]}{'…' if len(words) > 40 else ''} ({kind})"
