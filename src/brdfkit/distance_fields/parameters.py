"""Parameters of distance fields: dataclass fields that are checked when a node is made."""

from collections.abc import Mapping
from dataclasses import field
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.arguments import to_number, to_whole_number, wrong_value_error
from brdfkit.core.errors import no_such_error

_KINDS: dict[str, type] = {}


def register_node_class(cls: type) -> None:
    """Register a class of nodes, so that files and operators find it by its name."""
    _KINDS[cls.__name__] = cls


def find_node_class(name: Any, where: str = "") -> type:
    """Return the class of nodes with this name; `where` begins the error for an unknown name."""
    if not isinstance(name, str) or name not in _KINDS:
        raise no_such_error("node", name, sorted(_KINDS), where)
    return _KINDS[name]


def number(default: Any, least: float | None = None, above: float | None = None) -> Any:
    """Declare a parameter that is a number ≥ `least` or > `above`, or an array of Dr.Jit.

    The array may carry derivatives.
    """
    return field(default=default, metadata={"check": _check_number, "least": least, "above": above})


def vector(
    default: Any, above: float | None = None, least: float | None = None, spread: bool = False
) -> Any:
    """Declare a parameter of three numbers ≥ `least` or > `above`; `spread` allows one for all."""
    rules = {"check": _check_vector, "above": above, "least": least, "spread": spread}
    return field(default=default, metadata=rules)


def count(default: Any, least: int = 0, optional: bool = False) -> Any:
    """Declare a parameter that is a whole number, so that no optimiser may change it.

    optional : whether None is allowed.
    """
    rules = {"check": _check_count, "least": least, "optional": optional, "fixed": True}
    return field(default=default, metadata=rules)


def check_value(what: str, value: Any, rules: Mapping[str, Any]) -> Any:
    """Return `value` in the form in which its field stores it; raise `BrdfkitError` if invalid.

    what : name of the field, for the error message.
    rules : metadata of the field.
    """
    check = rules.get("check")
    return check(what, value, rules) if check else value


def _check_number(what: str, value: Any, rules: Mapping[str, Any]) -> Any:
    """Return a number within its bounds as a float; a Dr.Jit array is returned unchecked."""
    if dr.is_array_v(value):
        return value
    return to_number(what, value, rules["least"], above=rules["above"])


def _check_vector(what: str, value: Any, rules: Mapping[str, Any]) -> tuple[Any, ...]:
    """Return three checked numbers, from a triple, an object with x, y and z, or one number."""
    if rules["spread"] and isinstance(value, int | float | np.number):
        value = (value,) * 3
    if hasattr(value, "x"):
        value = value.x, value.y, value.z
    if not isinstance(value, tuple | list | np.ndarray) or len(value) != 3:
        raise wrong_value_error(what, value, "three numbers")
    return tuple(_check_number(f"{what}[{i}]", v, rules) for i, v in enumerate(value))


def _check_count(what: str, value: Any, rules: Mapping[str, Any]) -> int | None:
    """Return a whole number as an int, or None where the field is optional."""
    if value is None and rules["optional"]:
        return None
    return to_whole_number(what, value, rules["least"])
