"""The error that brdfkit raises for people to read, and the proposal of a similar name."""


class BrdfkitError(ValueError):
    """What is wrong, in which file or parameter, and what to do: one sentence.

    The command line prints it and leaves with status 2; nothing was half-written.
    """


def no_such(what, name, known, where=""):
    """The error for a `name` that is none of the `known`; it proposes the nearest of them.

    >>> no_such("model", "wrad", ["ggx", "ward"])
    BrdfkitError("There is no model 'wrad'; did you mean ward? There are ggx, ward.")
    """
    known = list(known)
    place = f"{where}: there" if where else "There"
    near = nearest(name, known)
    guess = f"did you mean {near}? There are" if near else "there are"
    return BrdfkitError(f"{place} is no {what} {name!r}; {guess} {', '.join(known) or 'none'}.")


def nearest(name, known):
    """The name among `known` that is most like `name`, None where none is similar."""
    import difflib  # only here: `--help` should be instant

    known = list(known)
    lower = [str(n).lower() for n in known]
    near = difflib.get_close_matches(str(name).lower(), lower, n=1)
    return known[lower.index(near[0])] if near else None
