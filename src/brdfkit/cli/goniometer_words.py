"""Turns words of `brdfkit measure` into a surface, its facets, a table's shape and a file."""

import shlex

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_writable
from brdfkit.materials.goniometer import microgeometry


def surface(geometry, **parameters):
    """The microgeometry of a name, with those of the `parameters` that are not None."""
    given = {name: value for name, value in parameters.items() if value is not None}
    return microgeometry.make(geometry, **given)


def facets(words, alpha):
    """The dictionary of a BSDF for each of the words ``METAL``, ``paint:R,G,B``, ``plastic:R,G,B``.

    >>> facets(["paint:0.8,0.7,0.6"], alpha=0.2)[0]["type"]
    'diffuse'
    """
    if not 0.01 <= alpha <= 1:
        raise BrdfkitError(f"facet-alpha = {alpha:g} is out of bounds; give one from 0.01 to 1.")
    return [_bsdf(word, alpha) for word in words]


def shape(text):
    """The shape of a table, of ``N,N,N`` or ``N,N,N,N``; None of None."""
    return text and _numbers(text, int, f"The shape {text!r} should read N,N,N or N,N,N,N.")


def command_line(parameters):
    """The command line with all `parameters` that determine the measurement."""
    words = ["brdfkit", "measure", parameters["geometry"]]
    for name, value in parameters.items():
        if name not in ("geometry", "output", "force", "as_json", "quiet") and value is not None:
            for single in value if isinstance(value, tuple) else (value,):
                words += [f"--{name.replace('_', '-')}", str(single)]
    return shlex.join(words)


def measurement_file(path):
    """`path`; an error where it cannot be written, or where its format holds no standard errors."""
    if path.suffix.lower() != ".npz":
        raise BrdfkitError(
            f"{path}: a measurement is written as .npz; name such a file, and convert it later."
        )
    require_writable(path)
    return path


def _bsdf(word, alpha):
    """The dictionary of a BSDF for one word."""
    kind, colon, colour = word.partition(":")
    rough = {"distribution": "ggx", "alpha": alpha}
    if not colon:
        return {"type": "roughconductor", "material": kind, **rough}
    wrong = f"The facets {word!r} should read METAL, or paint:R,G,B or plastic:R,G,B from 0 to 1."
    reflectance = {"type": "rgb", "value": _numbers(colour, float, wrong)}
    if len(reflectance["value"]) != 3 or not all(0 <= v <= 1 for v in reflectance["value"]):
        raise BrdfkitError(wrong)
    if kind == "paint":
        return {"type": "diffuse", "reflectance": reflectance}
    if kind == "plastic":
        return {"type": "roughplastic", "diffuse_reflectance": reflectance, **rough}
    raise BrdfkitError(wrong)


def _numbers(text, kind, wrong):
    """The numbers of a text with commas, of type `kind`; `wrong`: the error's sentence."""
    try:
        return [kind(part) for part in text.split(",")]
    except ValueError as error:
        raise BrdfkitError(wrong) from error
