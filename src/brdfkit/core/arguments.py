"""Checks arguments of public verbs: a wrong one is an error that names it."""

import sys
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError

LARGEST = sys.float_info.max  # that an int may exceed


def to_whole_number(what, value, least):
    """`value` as an int of at least `least`; `what` names the argument in the error."""
    if not isinstance(value, int | np.integer) or value < least:
        raise BrdfkitError(f"{what} = {value!r} should be a whole number, at least {least}.")
    return int(value)


def to_dictionary(what, given):
    """`given` as a dictionary by parameter, empty for None."""
    if not isinstance(given, Mapping | None):
        raise BrdfkitError(f"{what} = {given!r} should be a dictionary by parameter.")
    return dict(given or {})


def to_pair(what, given):
    """`given` as two floats."""
    try:
        low, high = map(float, given)
    except (TypeError, ValueError):
        raise BrdfkitError(f"{what} = {given!r} should be two numbers, (low, high).") from None
    return low, high


def to_number(what, value):
    """`value` as a finite float."""
    if not isinstance(value, int | float | np.number) or not abs(value) <= LARGEST:
        raise BrdfkitError(f"{what} = {value!r} should be a number.")
    return float(value)


def to_positive(what, value):
    """`value` as a float above 0 and finite."""
    if not isinstance(value, int | float | np.number) or not 0 < value <= LARGEST:
        raise BrdfkitError(f"{what} = {value!r} should be a number above 0.")
    return float(value)


def check_numbers(solver: Any) -> None:
    """Raise `BrdfkitError` unless the fields of a frozen dataclass are above 0, and whole where
    their defaults are."""
    for field in fields(solver):
        what, value = f"{type(solver).__name__}: {field.name}", getattr(solver, field.name)
        whole = isinstance(field.default, int)
        checked = to_whole_number(what, value, least=1) if whole else to_positive(what, value)
        object.__setattr__(solver, field.name, checked)
