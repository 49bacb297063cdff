"""Checks the numbers that solvers are made with."""

from dataclasses import fields
from typing import Any

from brdfkit.core.arguments import to_positive, to_whole_number


def check_numbers(solver: Any) -> None:
    """Raise `BrdfkitError` unless the fields of a frozen dataclass are above 0, and whole where
    their defaults are."""
    for field in fields(solver):
        what, value = f"{type(solver).__name__}: {field.name}", getattr(solver, field.name)
        whole = isinstance(field.default, int)
        checked = to_whole_number(what, value, least=1) if whole else to_positive(what, value)
        object.__setattr__(solver, field.name, checked)
