"""`PictureLoop`: renders the newest state of a view, pass by pass, for one page.

`work` renders the next pass and returns the picture; a thread (`render_thread.py`) calls it as long
as `has_work`. Only the newest state is rendered, and no picture is sent before the page has shown
the last one.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.images.errors.noise import Accumulated
from brdfkit.rendering.progressive import derive_seed
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.controls import State
from brdfkit.viewing.passes import Kind, Pass, mix_pictures
from brdfkit.viewing.pictures import describe_error, describe_noise, make_pictures

LARGEST_SAMPLES = 1024  # per pixel, after which a picture counts as converged
FIRST_PASSES = 4  # each of which is shown, since every pass is a visible gain
REST_INTERVAL = 0.25  # seconds between two pictures after the first passes
PATIENCE = 10.0  # seconds without a word on the last picture, after which nobody seems to look
LONGEST_WAIT = 0.2  # seconds for which a pass waits for a message that is answered meanwhile


class PictureLoop:
    """The picture of a view: its state, its samples, and the tasks that come before them."""

    def __init__(self, application: Application, state: State) -> None:
        self.application, self.state = application, dict(state)
        self.lock = threading.RLock()  # no function that runs kernels takes it
        self.size, self.visible, self.paused, self.moving = (512, 512), True, False, False
        self.number, self.shown = 0, 0  # of the last picture that was sent, and that is shown
        self.opened = 0  # how often something was opened
        self.tasks: list[Iterator[list[Message]]] = []
        self.ready: list[list[Message]] = []  # that were computed aside
        self.plots_first = False  # whether plots are drawn before the next picture
        # The pictures that were sent last, by side: linear, and sRGB in 8 bits
        self.sent: tuple[dict[int, AnyArray], dict[int, AnyArray]] = {}, {}
        self.sent_state = self.state  # that they show
        self.forget_samples()

    def forget_samples(self) -> None:
        """Begin the picture anew."""
        self.accumulated: dict[int, Accumulated] = {}
        self.previews: dict[int, AnyArray] = {}  # without noise, by side
        self.passes, self.converged, self.stale = 0, False, True
        self.plots_first = self.plots_first and self.moving  # else a new model's picture is first
        self.started, self.last_sent = time.monotonic(), 0.0

    def has_work(self) -> bool:
        """Return whether there is a pass to render, and someone who looks.

        False while a message is answered, which may take long, so that other sessions go on.
        """
        if not self.lock.acquire(blocking=False):
            return False
        try:
            return bool(self.ready or self.tasks) or self._has_pass() or self._has_plots()
        finally:
            self.lock.release()

    def compute_aside(self, make_messages: Callable[[], list[Message]]) -> None:
        """Compute messages in a thread of their own, while pictures go on; then send them.

        They are left aside if something else was opened meanwhile.
        """
        opened = self.opened

        def compute() -> None:
            try:
                messages = make_messages()
            except Exception as error:  # the page must hear of a defect of ours, too
                messages = [describe_error(error)]
            with self.lock:
                if opened == self.opened:
                    self.ready.append(messages)

        threading.Thread(target=compute, daemon=True).start()

    def _has_pass(self) -> bool:
        """Return whether there is a pass of the picture to render, and someone who looks."""
        waits = self.shown < self.number  # for the page, which is slow or gone
        gone = waits and time.monotonic() - self.last_sent > PATIENCE
        if not self.visible or gone or (waits and (self.moving or self.stale)):
            return False
        if not self.application.sides(self.state):
            return False
        return self.stale or not (self.paused or self.converged or self.moving)

    def _has_plots(self) -> bool:
        """Return whether plots are to be drawn now: after a picture, or if none is urgent."""
        first = self.plots_first or not self.stale or not self._has_pass()
        return first and self.visible and self.application.has_plot(self.state, self.moving)

    def work(self) -> list[Message]:
        """Render a pass of the newest state, and return its pictures if the page waits for them.

        Tasks, such as a film, come first, step by step, but for the first passes of a changed
        picture. Plots beside it and passes take turns, so that none of them waits for the end of a
        drag. All is computed outside of the lock, so that messages are answered meanwhile.
        """
        with self._lock_briefly() as locked:
            if not locked:
                return []
            if self.ready:
                return self.ready.pop(0)
            do = self._choose_work()
        return do()

    def _choose_work(self) -> Callable[[], list[Message]]:
        """Return what `work` does now."""
        if self._has_plots():
            self.plots_first = False
            return partial(self.application.draw_plots, self.state, self.moving)
        changed = self.stale or self.passes < FIRST_PASSES
        if self.tasks and not (changed and self._has_pass()):
            return partial(self._continue_task, self.tasks[0])
        return partial(self._render_pass, self._begin_pass())

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

    def _continue_task(self, task: Iterator[list[Message]]) -> list[Message]:
        """Return the messages of the next step of a task, unless it is needed no more."""
        messages, defect = None, None
        try:
            messages = next(task, None)
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
        kind, size = self._choose_kind(), self.picture_size(self.moving)
        self.stale, self.plots_first = False, True
        samples, previews = self.accumulated, self.previews
        application, state = self.application, self.state
        return Pass(application, kind, state, size, self.passes, samples, previews, self.opened)

    def _choose_kind(self) -> Kind:
        """Return what the next pass is to be."""
        if self.moving:
            return Kind.MOVE
        if self.stale and self.accumulated:
            return Kind.DEVELOP
        sizes = self.picture_size(), self.picture_size(moving=True)
        wants = not self.previews and self.application.wants_preview
        return Kind.PREVIEW if wants and wants(self.state, sizes, self.passes) else Kind.SAMPLE

    def _render_pass(self, begun: Pass) -> list[Message]:
        """Render a pass, and return its pictures if it is time to send them."""
        try:
            rendered = self._render_sides(begun)
        except BrdfkitError:
            if begun.samples is self.accumulated:
                raise
            return []  # an old state need not be possible any more, as with another volume
        done = begun.add(rendered)
        with self._lock_briefly() as locked:
            number = self._end_pass(begun, done) if locked else None
            self.stale = self.stale or not locked  # what was rendered in vain is rendered again
            lossless = self.converged and not begun.moving
        if number is None:
            return []
        app, state = begun.application, begun.state
        common = {"number": number, "overlay": app.overlay(state, begun.size)}
        previews = {} if lossless else done.previews
        pictures = rendered if begun.moving else mix_pictures(done.samples, previews)
        colours = app.develop(state, pictures, begun.moving)
        self.sent, self.sent_state = (pictures, colours), state
        messages = make_pictures(app, state, colours, common, lossless)
        return [*messages, self.describe_progress()]

    def _render_sides(self, begun: Pass) -> dict[int, AnyArray]:
        """Render a pass of each side."""
        if begun.kind == Kind.DEVELOP:
            return {}
        app, state, seed = begun.application, begun.state, derive_seed(0, begun.number)
        calm = begun.kind in (Kind.MOVE, Kind.PREVIEW)
        sizes = [begun.size]
        if begun.kind == Kind.PREVIEW and begun.number:  # the first move would wait for kernels
            sizes.insert(0, self.picture_size(moving=True))
        for size in sizes:
            if begun.samples is not self.accumulated and not begun.moving:
                return {}  # something moves by now
            rendered = {
                side: app.render(state, side, size, calm, seed) for side in range(app.sides(state))
            }
        return rendered

    def _end_pass(self, begun: Pass, done: Pass) -> int | None:
        """Keep the samples of a pass; return the number of its picture if it is sent."""
        if begun.samples is self.accumulated:
            self.passes += begun.kind == Kind.SAMPLE
            self.converged = not begun.moving and self.passes >= LARGEST_SAMPLES
            self.accumulated = done.samples
            self.previews = {} if self.converged else done.previews
        elif not begun.moving or begun.opened != self.opened:
            return None  # the state has changed, and this picture is of the old one
        now = time.monotonic()
        first = begun.number < FIRST_PASSES
        urgent = begun.kind != Kind.SAMPLE or self.converged or first
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
