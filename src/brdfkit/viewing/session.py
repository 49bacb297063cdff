"""`Session`: the conversation with one page or widget, free of web code.

The page sends messages, and `handle` returns the answers. Its picture is the `PictureLoop`'s.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.canvas_sizes import choose_size
from brdfkit.viewing.controls import State, has_other_samples
from brdfkit.viewing.picture_loop import PictureLoop
from brdfkit.viewing.pictures import describe_error
from brdfkit.viewing.undo import UndoSteps

SIDES = "width", "height"
BESIDE = ("plots.",)  # beginnings of the names that concern nothing in the picture


class Session(PictureLoop):
    """One view: its picture, its undo steps, and the answers to its page."""

    def __init__(self, application: Application) -> None:
        super().__init__(application, application.first_state())
        self.answered = 0  # the page's number of the message that was handled last
        self.open(self.state)

    def open(self, state: State) -> None:
        """Begin anew with a state, as for another volume."""
        self.opened += 1
        self.state, self.first = dict(state), dict(state)
        self.steps, self.moving = UndoSteps(state), False
        self.tasks, self.sent = [], ({}, {})
        self.forget_samples()

    def exchange(self, application: Application) -> list[Message]:
        """Show another application; return the messages that the page needs."""
        self.application.close()
        self.application = application
        self.open(application.first_state())
        return [self.describe_view(), *application.follow({}, self.state)]

    def close(self) -> None:
        """End what goes on, because the page is gone."""
        with self.lock:
            self.tasks = []
            self.application.close()

    def handle(self, message: dict[str, Any], data: bytes = b"") -> list[Message]:
        """Return the answers to a message of the page; an error becomes a message, too."""
        with self.lock:
            try:
                self.answered = to_whole_number("message", message.get("message", self.answered), 0)
                return self._answer(message, data)
            except Exception as error:  # the page must hear of a defect of ours, too
                return [describe_error(error), self.describe_state()]

    def _answer(self, message: dict[str, Any], data: bytes) -> list[Message]:
        kind = message.get("type")
        if kind == "hello":
            self._resize(message)
            self.shown, self.stale = self.number, True
            notes = self._restore(message.get("state"))
            return [self.describe_view(), *notes, *self.application.follow({}, self.state)]
        if kind == "set":
            return self._set(message)
        if kind in ("undo", "redo", "reset"):
            return self._step(kind)
        if kind == "resize":
            self._resize(message)
            return []
        if kind == "shown":
            number = to_whole_number("number", message.get("number"), 0)
            self.shown = max(self.shown, min(number, self.number))
            return []
        if kind == "cancel":
            self.tasks = []
            return [({"type": "busy", "text": "", "fraction": None}, [])]
        if kind in ("pause", "visible"):
            self.paused = bool(message.get("paused", self.paused))
            self.visible = bool(message.get("visible", self.visible))
            return [self.describe_progress()]
        return self.application.answer(self, message, data)

    def _restore(self, state: Any) -> list[Message]:
        """Show the state of the page's address, with the subject that it shows.

        A damaged state, that of another subject, and an impossible one are said, and left aside.
        """
        if state is None:
            return []
        if not isinstance(state, dict):
            text = "The address is damaged: its settings cannot be read, and are left aside."
            return [({"type": "error", "text": text}, [])]
        state, shown = dict(state), self.application.subject
        subject = state.pop("subject", shown)
        if subject != shown:
            text = (
                f"The address has settings of {str(subject)[:80]}; they are left aside, because "
                f"{shown} is shown."
            )
            return [({"type": "error", "text": text}, [])]
        try:
            self.change(state, moving=False)
        except BrdfkitError as error:
            text = f"All settings of the address are left aside, because one is wrong: {error}"
            return [({"type": "error", "text": text}, [])]
        return []

    def describe_view(self) -> Message:
        """Return the message "open", with the state.

        Pictures up to its number show what was there before.
        """
        message, buffers = self.application.describe()
        own = {"type": "open", "subject": self.application.subject, "number": self.number}
        return message | self.describe_state()[0] | own, buffers

    def describe_state(self) -> Message:
        """Return the message "state", with the number of the message that it answers."""
        own = {"type": "state", "state": self.state, "answered": self.answered}
        return own | self.steps.describe(), []

    def _set(self, message: dict[str, Any]) -> list[Message]:
        changes, moving = message.get("changes"), bool(message.get("moving"))
        if not isinstance(changes, dict):
            raise BrdfkitError("The page sent a message without changes; load it again.")
        before, expected = self.state, self.state | changes
        self.change(changes, moving)
        state = [self.describe_state()] if not moving or self.state != expected else []
        return [*state, *self.application.follow(before, self.state)]

    def change(self, changes: Mapping[str, Any], moving: bool = False) -> None:
        """Change the state; the end of a move makes an undo step."""
        self._show(self.application.change(self.state, changes), moving)
        if not moving:
            self.steps.remember(self.state)

    def _show(self, state: State, moving: bool) -> None:
        """Show another state."""
        anew = self.application.needs_samples_anew(self.state, state)
        if anew or self.moving:
            self.moving = moving
            self.forget_samples()
        beside = not has_other_samples(self.state, state, BESIDE)
        self.state, self.stale = dict(state), self.stale or not beside

    def _step(self, kind: str) -> list[Message]:
        """Undo, redo, or go back to the first state."""
        before = self.state
        if kind == "reset":
            self.change(self.first)
        else:
            self._show(self.steps.undo() if kind == "undo" else self.steps.redo(), moving=False)
        return [self.describe_state(), *self.application.follow(before, self.state)]

    def _resize(self, message: Mapping[str, Any]) -> None:
        """Take over the size of the page's canvas [pixels], in steps."""
        width, height = (to_whole_number(name, message.get(name), 1) for name in SIDES)
        size = choose_size(width, height)
        if size != self.size:
            self.size = size
            self.forget_samples()
