"""Mends of a measured file: arguments of `brdfkit.load` that convert it, as flags of a view.

The state has the flag of each under "mend." and its name, if the file can be converted so. While
one is set, `FILE` stands for the material as the file says on a side of the wipe.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.conventions import can_mend
from brdfkit.viewing.controls import Control, State
from brdfkit.viewing.materials.picture_controls import FILE, MEASURED, MODEL

PREFIX = "mend."  # of the names in the state
PANEL = "audit"
LABELS = {
    "mirror_azimuth": ("Mirror azimuths", "Add 180° to the azimuth φo of every view."),
    "divide_by_cos": ("Divide by cos θo", "Divide the values by the cosine of the view."),
}

Mends = tuple[str, ...]  # the arguments that are set


def make_mend_controls(file: Any) -> list[Control]:
    """Return the flags of the mends that a material allows as its file says."""
    possible = isinstance(file, Measured)
    return [
        Control(PREFIX + name, label, PANEL, False, kind="flag", help=meaning)
        for name, (label, meaning) in LABELS.items()
        if possible and can_mend(file, name)
    ]


def refuse_mend(file: Any, name: str) -> BrdfkitError:
    """Return the error for a flag that a material does not have, with the reason."""
    option = name.removeprefix(PREFIX)
    if option in LABELS and not isinstance(file, Measured):
        return BrdfkitError("A model is never mended; give a measured material.")
    if option in LABELS:
        try:
            file.mend(**{option: True})
        except BrdfkitError as error:
            return error
    return no_such_error("setting", name, [PREFIX + known for known in LABELS])


def find_mends(state: State) -> Mends:
    """Return the mends that a state sets."""
    return tuple(name for name in LABELS if state.get(PREFIX + name))


def show_file(state: State, changes: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return changes that, where they mend something, show the file as it says, too.

    It is right of the wipe, and the mended one left, unless the changes say what is right.
    """
    mends = set(find_mends({**state, **changes}))
    if mends <= set(find_mends(state)) or "second" in changes:
        return changes
    return {"renderer": MEASURED, "second": FILE, **changes}


def name_file(name: str, shown: str) -> str:
    """Return the name of a file of which something is mended, or of the file as it says."""
    return f"{name} as the file says" if shown == FILE else f"{name}, mended"


def leave_file(state: State) -> State:
    """Return a state whose sides show the file only if something is mended."""
    if find_mends(state):
        return state
    usual = {"renderer": MEASURED, "second": MODEL}
    return state | {side: other for side, other in usual.items() if state[side] == FILE}


class MendedFile:
    """A measured file, and what it becomes by mends.

    >>> MendedFile(load("mirrored.astm")).find(("mirror_azimuth",))    # doctest: +SKIP
    """

    def __init__(self, file: Any) -> None:
        self.file = file
        self.made: dict[Mends, Any] = {(): file}

    def find(self, mends: Mends) -> Any:
        """Return the material with mends; the same object each time."""
        if mends not in self.made:
            self.made[mends] = self.file.mend(**dict.fromkeys(mends, True))
        return self.made[mends]
