"""The error class of brdfkit, and errors for unknown names, which propose a similar one."""

from collections.abc import Iterable
from typing import Any


class BrdfkitError(ValueError):
    """An error in one sentence: what is wrong, in which file or parameter, and what to do.

    The command line prints it and ends with status 2. Files are never left half-written.
    """


def no_such_error(what: str, name: object, known: Iterable[Any], where: str = "") -> BrdfkitError:
    """Return the error for an unknown `name` of a thing `what`; it proposes the nearest known name.

    `where` is the file or object that lacks the name.

    >>> no_such_error("model", "wrad", ["ggx", "ward"])
    BrdfkitError("There is no model 'wrad'; did you mean ward? There are ggx, ward.")
    """
    names = list(map(str, known))
    place = f"{where}: there" if where else "There"
    near = find_nearest_name(name, names)
    guess = f"did you mean {near}? There are" if near else "there are"
    return BrdfkitError(f"{place} is no {what} {name!r}; {guess} {', '.join(names) or 'none'}.")


def find_nearest_name(name: object, known: Iterable[Any]) -> Any:
    """Return the known name that is most similar to `name`, None where none is similar."""
    import difflib  # imported here to keep `--help` fast

    known = list(known)
    lower = [str(n).lower() for n in known]
    near = difflib.get_close_matches(str(name).lower(), lower, n=1)
    return known[lower.index(near[0])] if near else None
