"""`Session`: the state machine behind one page or widget, free of web code.

The page sends messages, and `handle` returns the answers. `work` renders the next pass and returns
the picture; a thread (`render_thread.py`) calls it as long as `has_work`. Only the newest state is
rendered, and no picture is sent before the page has shown the last one.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.images.errors.noise import Accumulated
from brdfkit.rendering.progressive import derive_seed
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.canvas_sizes import choose_size
from brdfkit.viewing.controls import State
from brdfkit.viewing.passes import Pass, add_passes
from brdfkit.viewing.pictures import describe_error, describe_noise, make_pictures
from brdfkit.viewing.undo import UndoSteps

LARGEST_SAMPLES = 1024  # per pixel, after which a picture counts as converged
FIRST_PASSES = 4  # each of which is shown, since every pass is a visible gain
REST_INTERVAL = 0.25  # seconds between two pictures after the first passes
SIDES = "width", "height"
PATIENCE = 10.0  # seconds without a word on the last picture, after which nobody seems to look
LONGEST_WAIT = 0.2  # seconds for which a pass waits for a message that is answered meanwhile


class Session:
    """One view: its state, its undo steps and its picture."""

    def __init__(self, application: Application) -> None:
        self.application = application
        self.lock = threading.RLock()  # no function that runs kernels takes it
        self.size, self.visible, self.paused = (512, 512), True, False
        self.number, self.shown = 0, 0  # of the last picture that was sent, and that is shown
        self.opened = 0  # how often something was opened
        self.open(application.first_state())

    def open(self, state: State) -> None:
        """Begin anew with a state, as for another volume."""
        self.opened += 1
        self.state, self.first = dict(state), dict(state)
        self.steps, self.moving = UndoSteps(state), False
        self.tasks: list[Iterator[list[Message]]] = []
        self.forget_samples()

    def close(self) -> None:
        """End what goes on, because the page is gone."""
        with self.lock:
            self.tasks = []
            self.application.close()

    def forget_samples(self) -> None:
        """Begin the picture anew."""
        self.accumulated: dict[int, Accumulated] = {}
        self.passes, self.converged, self.stale = 0, False, True
        self.started, self.last_sent = time.monotonic(), 0.0

    # Messages

    def handle(self, message: dict[str, Any], data: bytes = b"") -> list[Message]:
        """Return the answers to a message of the page; an error becomes a message, too."""
        with self.lock:
            try:
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

        The state of another subject, and an impossible one, is said, and left aside.
        """
        if not isinstance(state, dict):
            return []
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
            return [({"type": "error", "text": f"The address has another state: {error}"}, [])]
        return []

    def describe_view(self) -> Message:
        """Return the message "open", with the state.

        Pictures up to its number show what was there before.
        """
        message, buffers = self.application.describe()
        own = {"type": "open", "subject": self.application.subject, "number": self.number}
        return message | self.describe_state()[0] | own, buffers

    def describe_state(self) -> Message:
        """Return the message "state"."""
        return {"type": "state", "state": self.state} | self.steps.describe(), []

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
        self.state, self.stale = dict(state), True

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

    # Pictures

    def has_work(self) -> bool:
        """Return whether there is a pass to render, and someone who looks.

        False while a message is answered, which may take long, so that other sessions go on.
        """
        if not self.lock.acquire(blocking=False):
            return False
        try:
            return bool(self.tasks) or self._has_pass()
        finally:
            self.lock.release()

    def _has_pass(self) -> bool:
        """Return whether there is a pass of the picture to render, and someone who looks."""
        waits = self.shown < self.number  # for the page, which is slow or gone
        gone = waits and time.monotonic() - self.last_sent > PATIENCE
        if not self.visible or gone or (waits and (self.moving or self.stale)):
            return False
        return self.stale or not (self.paused or self.converged or self.moving)

    def work(self) -> list[Message]:
        """Render a pass of the newest state, and return its pictures if the page waits for them.

        Tasks, such as a film, come first, step by step, but for the first passes of a changed
        picture. All is rendered and encoded outside of the lock, so that messages are answered
        meanwhile.
        """
        with self._lock_briefly() as locked:
            if not locked:
                return []
            changed = self.stale or self.passes < FIRST_PASSES
            task = self.tasks[0] if self.tasks and not (changed and self._has_pass()) else None
            begun = None if task else self._begin_pass()
        return self._continue_task(task) if begun is None else self._render_pass(begun)

    @contextmanager
    def _lock_briefly(self) -> Iterator[bool]:
        """Take the lock for the block, which gets False if a long answer, as to a file, has it.

        The thread that renders waits for no answer, because it works for other pages, too.
        """
        locked = self.lock.acquire(timeout=LONGEST_WAIT)
        try:
            yield locked
        finally:
            if locked:
                self.lock.release()

    def _continue_task(self, task: Iterator[list[Message]] | None) -> list[Message]:
        """Return the messages of the next step of a task, unless it is needed no more."""
        messages, defect = None, None
        try:
            messages = None if task is None else next(task, None)
        except Exception as error:  # which nobody needs to know of a task that was given up
            defect = error
        with self.lock:
            if task not in self.tasks:
                return []
            if messages is None:
                self.tasks.remove(task)
        if defect is not None:
            raise defect
        return messages or []

    def _begin_pass(self) -> Pass:
        moving, samples = self.moving, self.accumulated
        anew, self.stale = self.stale and bool(samples), False
        size = self.picture_size(moving)
        return Pass(self.state, moving, size, self.passes, samples, anew, self.opened)

    def _render_pass(self, begun: Pass) -> list[Message]:
        """Render a pass, and return its pictures if it is time to send them."""
        try:
            passes = {} if begun.anew else self._render_sides(begun)
        except BrdfkitError:
            if begun.samples is self.accumulated:
                raise
            return []  # an old state need not be possible any more, as with another volume
        samples = {} if begun.moving else add_passes(begun.samples, passes)
        with self._lock_briefly() as locked:
            number = self._end_pass(begun, samples) if locked else None
            self.stale = self.stale or not locked  # what was rendered in vain is rendered again
            lossless = self.converged and not begun.moving
        if number is None:
            return []
        app, state = self.application, begun.state
        common = {"number": number, "overlay": app.overlay(state, begun.size)}
        pictures = passes if begun.moving else {side: a.picture for side, a in samples.items()}
        messages = make_pictures(app, state, pictures, common, begun.moving, lossless)
        return [*messages, self.describe_progress()]

    def _render_sides(self, begun: Pass) -> dict[int, AnyArray]:
        """Render a pass of each side."""
        state, seed = begun.state, derive_seed(0, begun.number)
        return {
            side: self.application.render(state, side, begun.size, begun.moving, seed)
            for side in range(self.application.sides(state))
        }

    def _end_pass(self, begun: Pass, samples: dict[int, Accumulated]) -> int | None:
        """Keep the samples of a pass; return the number of its picture if it is sent."""
        if begun.samples is self.accumulated:
            self.passes += not begun.anew
            self.converged = not begun.moving and self.passes >= LARGEST_SAMPLES
            self.accumulated = samples
        elif not begun.moving or begun.opened != self.opened:
            return None  # the state has changed, and this picture is of the old one
        now = time.monotonic()
        first = begun.number < FIRST_PASSES
        urgent = begun.moving or begun.anew or self.converged or first
        if self.shown < self.number or not (urgent or now - self.last_sent > REST_INTERVAL):
            self.stale = self.stale or self.converged  # the last picture is sent later
            return None
        self.last_sent = now
        self.number += 1
        return self.number

    def picture_size(self, moving: bool = False) -> tuple[int, int]:
        """Return the size of the picture [pixels], which is smaller while something moves."""
        scale = self.state["view.moving_scale"] if moving else self.state["view.scale"]
        width, height = (round(side * scale) for side in self.size)
        return width, height

    def describe_progress(self) -> Message:
        """Return the message "progress"."""
        seconds = time.monotonic() - self.started
        return {
            "type": "progress",
            "samples": self.passes,
            "per_second": round(self.passes / seconds, 1) if seconds > 0 else 0.0,
            "noise": describe_noise(self.accumulated.get(0)),
            "paused": self.paused,
            "converged": self.converged,
        }, []
