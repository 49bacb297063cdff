"""`UndoSteps`: the states to which undo and redo lead."""

from __future__ import annotations

from brdfkit.viewing.controls import State

LARGEST_STEP_COUNT = 100  # of undo


class UndoSteps:
    """The states that a view has had, up to the present one, and those that were undone."""

    def __init__(self, first: State) -> None:
        self.done, self.undone = [dict(first)], list[State]()

    def remember(self, state: State) -> None:
        """Make a state a step, unless it is the present one."""
        if state != self.done[-1]:
            self.done = [*self.done, dict(state)][-LARGEST_STEP_COUNT:]
            self.undone = []

    def undo(self) -> State:
        """Return the state before the present one, or this one if there is none."""
        if len(self.done) > 1:
            self.undone.append(self.done.pop())
        return self.done[-1]

    def redo(self) -> State:
        """Return the state that was undone last, or the present one if there is none."""
        if self.undone:
            self.done.append(self.undone.pop())
        return self.done[-1]

    def describe(self) -> dict[str, bool]:
        """Return whether there is something to undo, and to redo, as the page reads it."""
        return {"can_undo": len(self.done) > 1, "can_redo": bool(self.undone)}
