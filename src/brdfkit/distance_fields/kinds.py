"""The kinds of nodes by their names, which operators and files know them by."""

from brdfkit.core.errors import no_such

_KINDS: dict[str, type] = {}


def add(cls):
    """Make a class of nodes known by its name."""
    _KINDS[cls.__name__] = cls


def kind(name, where=""):
    """The class of nodes of this name; `where` begins the error for a name that is none."""
    if not isinstance(name, str) or name not in _KINDS:
        raise no_such("node", name, sorted(_KINDS), where)
    return _KINDS[name]
