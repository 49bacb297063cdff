"""`Session`: the state machine behind one page or widget, free of web code.

The page sends messages, and `handle` returns the answers. `work` renders the next pass and returns
the picture; a thread (`render_thread.py`) calls it as long as `has_work`. Only the newest state is
rendered, and no picture is sent before the page has shown the last one.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Mapping
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.images.errors.noise import Accumulated
from brdfkit.rendering.progressive import derive_seed
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.controls import State
from brdfkit.viewing.encoding import encode_jpeg, encode_png

UNDO_STEPS = 100
LARGEST_SAMPLES = 1024  # per pixel, after which a picture counts as converged
FIRST_PASSES = 4  # each of which is shown, since every pass is a visible gain
REST_INTERVAL = 0.25  # seconds between two pictures after the first passes
SIZE_STEP = 64  # pixels: every size of a picture needs kernels of its own, so there are few
SMALLEST_SIDE, LARGEST_SIDE = 64, 2048


class Session:
    """One view: its state, its undo steps and its picture."""

    def __init__(self, application: Application) -> None:
        self.application = application
        self.lock = threading.RLock()
        self.open(application.first_state())
        self.size, self.visible, self.paused = (512, 512), True, False

    def open(self, state: State) -> None:
        """Begin anew with a state, as for another volume."""
        self.state, self.first = dict(state), dict(state)
        self.undo_states: list[State] = [dict(state)]
        self.redo_states: list[State] = []
        self.moving, self.number, self.shown = False, 0, 0
        self.tasks: list[Iterator[list[Message]]] = []
        self.forget_samples()

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
            except BrdfkitError as error:
                return [({"type": "error", "text": str(error)}, []), self.describe_state()]

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
            before = self.state
            getattr(self, f"_{kind}")()
            return [self.describe_state(), *self.application.follow(before, self.state)]
        if kind == "resize":
            self._resize(message)
            return []
        if kind == "shown":
            self.shown = max(self.shown, int(message.get("number", 0)))
            return []
        if kind in ("pause", "visible"):
            self.paused = bool(message.get("paused", self.paused))
            self.visible = bool(message.get("visible", self.visible))
            return [self.describe_progress()]
        return self.application.answer(self, message, data)

    def _restore(self, state: Any) -> list[Message]:
        """Show the state of the page's address; an impossible one is said, and left aside."""
        if not isinstance(state, dict):
            return []
        try:
            self._change(state, moving=False)
        except BrdfkitError as error:
            return [({"type": "error", "text": f"The address has another state: {error}"}, [])]
        return []

    def describe_view(self) -> Message:
        """Return the message "open", with the state."""
        message, buffers = self.application.describe()
        return message | self.describe_state()[0] | {"type": "open"}, buffers

    def describe_state(self) -> Message:
        """Return the message "state"."""
        steps = {"can_undo": len(self.undo_states) > 1, "can_redo": bool(self.redo_states)}
        return {"type": "state", "state": self.state} | steps, []

    def _set(self, message: dict[str, Any]) -> list[Message]:
        changes, moving = message.get("changes"), bool(message.get("moving"))
        if not isinstance(changes, dict):
            raise BrdfkitError("The page sent a message without changes; load it again.")
        before, expected = self.state, self.state | changes
        self._change(changes, moving)
        state = [self.describe_state()] if not moving or self.state != expected else []
        return [*state, *self.application.follow(before, self.state)]

    def _change(self, changes: Mapping[str, Any], moving: bool) -> None:
        """Change the state; the end of a move makes an undo step."""
        self._show(self.application.change(self.state, changes), moving)
        if not moving and self.state != self.undo_states[-1]:
            self._remember()

    def _show(self, state: State, moving: bool) -> None:
        """Show another state."""
        anew = self.application.needs_samples_anew(self.state, state)
        if anew or self.moving:
            self.moving = moving
            self.forget_samples()
        self.state, self.stale = dict(state), True

    def replace_state(self, state: State) -> None:
        """Show a state that the application made, as another undo step."""
        self._show(state, moving=False)
        self._remember()

    def _remember(self) -> None:
        """Make the state an undo step."""
        self.undo_states = [*self.undo_states, dict(self.state)][-UNDO_STEPS:]
        self.redo_states = []

    def _undo(self) -> None:
        if len(self.undo_states) > 1:
            self.redo_states.append(self.undo_states.pop())
            self._show(self.undo_states[-1], moving=False)

    def _redo(self) -> None:
        if self.redo_states:
            self.undo_states.append(self.redo_states.pop())
            self._show(self.undo_states[-1], moving=False)

    def _reset(self) -> None:
        self._change(self.first, moving=False)

    def _resize(self, message: Mapping[str, Any]) -> None:
        """Take over the size of the page's canvas [pixels], in steps."""
        size = [message.get("width", self.size[0]), message.get("height", self.size[1])]
        if not all(isinstance(side, int) and side > 0 for side in size):
            raise BrdfkitError("The page sent no size of its picture; load it again.")
        width, height = (
            min(max(round(side / SIZE_STEP) * SIZE_STEP, SMALLEST_SIDE), LARGEST_SIDE)
            for side in size
        )
        if (width, height) != self.size:
            self.size = width, height
            self.forget_samples()

    # Pictures

    def has_work(self) -> bool:
        """Return whether there is a pass to render, and someone who looks.

        False while a message is answered, which may take long, so that other sessions go on.
        """
        if not self.lock.acquire(blocking=False):
            return False
        try:
            if self.tasks:
                return True
            if not self.visible or (self.shown < self.number and (self.moving or self.stale)):
                return False
            return self.stale or not (self.paused or self.converged or self.moving)
        finally:
            self.lock.release()

    def work(self) -> list[Message]:
        """Render a pass of the newest state, and return its pictures if the page waits for them.

        Tasks, such as a film, come first, step by step.
        """
        if self.tasks:
            messages = next(self.tasks[0], None)
            if messages is None:
                self.tasks.pop(0)
            return messages or []
        with self.lock:
            state, moving, number = self.state, self.moving, self.passes
            samples, size = self.accumulated, self._picture_size(moving)
            developed_anew = self.stale and bool(samples)  # no sample is missing
            self.stale = False
        if not developed_anew:
            for side in range(self.application.sides(state)):
                picture = self.application.render(state, side, size, moving, derive_seed(0, number))
                samples[side] = samples.get(side, Accumulated()).add_pass(picture, 1)
        with self.lock:
            if samples is not self.accumulated and not moving:
                return []  # the state has changed, and this picture is of the old one
            if samples is self.accumulated:
                self.passes += not developed_anew
                self.converged = not moving and self.passes >= LARGEST_SAMPLES
                if moving:
                    self.accumulated = {}
            now = time.monotonic()
            urgent = moving or developed_anew or self.converged or number < FIRST_PASSES
            if self.shown < self.number or not (urgent or now - self.last_sent > REST_INTERVAL):
                return []
            self.last_sent = now
            return self._send(state, samples, moving)

    def _picture_size(self, moving: bool) -> tuple[int, int]:
        """Return the size of the picture [pixels], which is smaller while something moves."""
        scale = self.state["view.moving_scale"] if moving else self.state["view.scale"]
        width, height = (max(round(side * scale / 32) * 32, 32) for side in self.size)
        return width, height

    def _send(self, state: State, samples: dict[int, Accumulated], moving: bool) -> list[Message]:
        """Return the pictures and the progress as messages."""
        messages: list[Message] = []
        self.number += 1
        overlay = self.application.overlay(state, self.size)
        for side, accumulated in sorted(samples.items()):
            colours = self.application.develop(state, accumulated.picture)
            lossless = self.converged and not moving
            mime = "image/png" if lossless else "image/jpeg"
            picture = {
                "type": "picture",
                "number": self.number,
                "side": side,
                "mime": mime,
                "overlay": overlay,
            }
            messages.append((picture, [encode_png(colours) if lossless else encode_jpeg(colours)]))
        return [*messages, self.describe_progress()]

    def describe_progress(self) -> Message:
        """Return the message "progress"."""
        seconds = time.monotonic() - self.started
        accumulated = self.accumulated.get(0)
        return {
            "type": "progress",
            "samples": self.passes,
            "per_second": round(self.passes / seconds, 1) if seconds > 0 else 0.0,
            "noise": describe_noise(accumulated),
            "paused": self.paused,
            "converged": self.converged,
        }, []


def describe_noise(accumulated: Accumulated | None) -> str:
    """Return the mean standard error of the pixels over their mean value, in words."""
    error = None if accumulated is None else accumulated.standard_error
    if accumulated is None or error is None or not accumulated.picture.mean() > 0:
        return ""
    return f"{100 * float(error.mean() / accumulated.picture.mean()):.2g} % noise"
