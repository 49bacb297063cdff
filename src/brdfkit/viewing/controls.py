"""`Control`: one setting of a view, as the page shows it, with the check of its values.

The state of a view is a dictionary of plain numbers, texts and lists by name. A control declares
one name of it: how the page shows it, and which values it may have. Names without a control, such
as the points of a transfer function, are checked by the application.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, TypeGuard

from brdfkit.core.arguments import is_number, wrong_value_error
from brdfkit.core.errors import BrdfkitError

State = dict[str, Any]

COLOUR = re.compile(r"#[0-9a-f]{6}", re.IGNORECASE)


@dataclass(frozen=True)
class Control:
    """A setting of the view.

    `name`: its name in the state. `label`: its text on the page. `panel`: the panel on which it is.
    `default`: its value at first. `kind`: "slider", "choice", "flag" or "colour". `low`, `high`,
    `step`, `log` and `unit` belong to a slider; `step` 0 means any number. `choices`: pairs (value,
    label). `when`: the values of other names with which the control does something, by name;
    otherwise the page hides it. `help`: a sentence for the page.
    """

    name: str
    label: str
    panel: str
    default: Any
    kind: str = "slider"
    low: float = 0.0
    high: float = 1.0
    step: float = 0.0
    log: bool = False
    unit: str = ""
    choices: tuple[tuple[Any, str], ...] = ()
    when: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)
    help: str = ""

    def check(self, value: Any) -> Any:
        """Return the value as the state keeps it; raise `BrdfkitError` if it is not allowed."""
        if self.kind == "flag" and isinstance(value, bool):
            return value
        if self.kind == "choice" and value in [choice for choice, _ in self.choices]:
            return value
        if self.kind == "colour" and is_colour(value):
            return value.lower()
        if self.kind == "slider" and is_number(value) and math.isfinite(value):
            number = min(max(float(value), self.low), self.high)
            return round(number) if self.step >= 1 and float(self.step).is_integer() else number
        raise BrdfkitError(
            f"{self.label}: {str(value)[:60]!r} is not possible; {self._expected()}."
        )

    def _expected(self) -> str:
        """Return what values are possible, in words."""
        if self.kind == "choice":
            return "choose one of " + ", ".join(str(choice) for choice, _ in self.choices)
        if self.kind == "slider":
            return f"give a number from {self.low:g} to {self.high:g}"
        return {"flag": "give true or false"}.get(self.kind, "give a colour such as #ff8800")

    def to_json(self) -> dict[str, Any]:
        """Return the control as the page reads it."""
        record = asdict(self) | {"when": {k: list(v) for k, v in self.when.items()}}
        return record | {"choices": [list(pair) for pair in self.choices]}


def is_colour(value: Any) -> TypeGuard[str]:
    """Return whether a value is a colour such as "#ff8800"."""
    return isinstance(value, str) and bool(COLOUR.fullmatch(value))


def to_changes(state: object) -> State:
    """Return the settings, by name, that a user gives; None are none.

    Raises `BrdfkitError` for anything else.
    """
    if state is None:
        return {}
    if not isinstance(state, Mapping):
        raise wrong_value_error("state", state, 'settings by name, as {"show.box": False}')
    return dict(state)


def default_state(controls: Iterable[Control]) -> State:
    """Return the state in which every control has its default."""
    return {control.name: control.default for control in controls}


def has_other_samples(before: State, after: State, drawn_only: tuple[str, ...]) -> bool:
    """Return whether a change of the state alters the samples of its picture.

    Names that begin as one of `drawn_only` do not: they concern the tone mapping, or what is drawn
    over the picture.
    """
    names = before.keys() | after.keys()
    changed = (name for name in names if before.get(name) != after.get(name))
    return any(not name.startswith(drawn_only) for name in changed)
