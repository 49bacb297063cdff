"""The parameters of nodes: fields of dataclasses that are checked when a node is made."""

from dataclasses import field

import drjit as dr
import numpy as np

from brdfkit.core.arguments import to_number, to_whole_number, wrong_argument
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


def number(default, least=None, above=None):
    """A field that holds a number, or an array of Dr.Jit's, which may carry derivatives."""
    return field(default=default, metadata={"check": _number, "least": least, "above": above})


def vector(default, above=None, least=None, spread=False):
    """A field of three numbers; with `spread` one number stands for three."""
    rules = {"check": _vector, "above": above, "least": least, "spread": spread}
    return field(default=default, metadata=rules)


def count(default, least=0, optional=False):
    """A field that holds a whole number, which is no parameter; None if `optional`."""
    rules = {"check": _count, "least": least, "optional": optional, "fixed": True}
    return field(default=default, metadata=rules)


def checked(what, value, rules):
    """`value` of the parameter called `what`, as its field holds it; an error where it cannot."""
    check = rules.get("check")
    return check(what, value, rules) if check else value


def _number(what, value, rules):
    if dr.is_array_v(value):
        return value
    return to_number(what, value, rules["least"], above=rules["above"])


def _vector(what, value, rules):
    if rules["spread"] and isinstance(value, int | float | np.number):
        value = (value,) * 3
    if hasattr(value, "x"):
        value = value.x, value.y, value.z
    if not isinstance(value, tuple | list | np.ndarray) or len(value) != 3:
        raise wrong_argument(what, value, "three numbers")
    return tuple(_number(f"{what}[{i}]", v, rules) for i, v in enumerate(value))


def _count(what, value, rules):
    if value is None and rules["optional"]:
        return None
    return to_whole_number(what, value, rules["least"])
