"""What the words of `brdfkit measure` mean: a surface, its facets, a table and a file."""

import shlex

from brdfkit.errors import BrdfkitError
from brdfkit.files import require_writable
from brdfkit.goniometer import microgeometry


def surface(geometry, **parameters):
    """The microgeometry of that name, with those of its `parameters` that are not None."""
    given = {name: value for name, value in parameters.items() if value is not None}
    return microgeometry.make(geometry, **given)


def facets(words, alpha):
    """Mitsuba's BSDFs of ``METAL``, ``paint:R,G,B`` and ``plastic:R,G,B``, one for each word.

    >>> facets(["paint:0.8,0.7,0.6"], alpha=0.2)[0]["type"]
    'diffuse'
    """
    if not 0.01 <= alpha <= 1:
        raise BrdfkitError(f"facet-alpha = {alpha:g} is out of bounds; give one from 0.01 to 1.")
    return [_bsdf(word, alpha) for word in words]


def cells(text):
    """The shape of a table from ``N,N,N`` or ``N,N,N,N``; None from None."""
    return text and _numbers(text, int, f"The cells {text!r} should read N,N,N or N,N,N,N.")


def command(parameters):
    """The command line in full: all parameters that say what is measured, and how."""
    words = ["brdfkit", "measure", parameters["geometry"]]
    for name, value in parameters.items():
        if name not in ("geometry", "output", "as_json", "quiet") and value is not None:
            for single in value if isinstance(value, tuple) else (value,):
                words += [f"--{name.replace('_', '-')}", str(single)]
    return shlex.join(words)


def measurement_file(path):
    """`path`, once it is sure that it can be written and is in a format that holds errors."""
    if path.suffix.lower() != ".npz":
        raise BrdfkitError(
            f"{path}: a measurement is written as .npz; `brdfkit convert` makes others of it."
        )
    require_writable(path)
    return path


def _bsdf(word, alpha):
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
    try:
        return [kind(part) for part in text.split(",")]
    except ValueError as error:
        raise BrdfkitError(wrong) from error
