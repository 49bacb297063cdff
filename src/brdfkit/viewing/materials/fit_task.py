"""`FitTask`: a fit that a page asked for, which the page can follow and cancel."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.fitting.fit import fit
from brdfkit.regression import Fit
from brdfkit.viewing.application import Message
from brdfkit.viewing.materials.error_table import describe_errors
from brdfkit.viewing.materials.parameter_state import to_state
from brdfkit.viewing.pictures import describe_error

if TYPE_CHECKING:
    from brdfkit.viewing.session import Session

NAME = "brdfkit fit"  # of the threads
INTERVAL = 0.1  # seconds between two messages of the progress


class _Cancelled(BrdfkitError):
    """Ends a fit from within, at its next step."""


class FitTask:
    """A fit of the model that a session shows, with the page's loss.

    It runs in a thread of its own, so that the task of the session only waits for it, in steps.
    """

    def __init__(self, application: Any, session: Session) -> None:
        self.application, self.session = application, session
        self.label, self.loss = session.state["model"], session.state["fit.loss"]
        self.cancelled, self.finished = threading.Event(), threading.Event()
        self.share = 0.0  # of the steps of the fit that are done
        self.result: Fit | None = None
        self.error: Exception | None = None

    @property
    def goes_on(self) -> bool:
        """Whether the fit is under way."""
        return not (self.cancelled.is_set() or self.finished.is_set())

    def run(self) -> Iterator[list[Message]]:
        """Fit the model, and show the fit; yields messages for the page.

        If the session gives the task up, the fit ends at its next step.
        """
        threading.Thread(target=self._fit, name=NAME, daemon=True).start()
        try:
            while not self.finished.wait(INTERVAL):
                yield [describe_progress(self.label, self.share)]
        finally:
            self.cancelled.set()
        if self.result is None:
            yield [describe_progress("", None), describe_error(self.error or BrdfkitError(""))]
        else:
            yield self._show(self.result)
            yield from describe_errors(self.application.states, self.session.state)
            yield [describe_progress("", None)]

    def _fit(self) -> None:
        """Do the work, and keep its result or its error."""
        states = self.application.states
        model = type(states.find_model(self.label))
        try:
            self.result = fit(states.measured, model, loss=self.loss, progress=self._report)
        except Exception as error:  # a page must hear of any
            self.error = error
        finally:
            self.finished.set()

    def _report(self, done: int, total: int) -> None:
        """Keep the progress of the fit; end it if it was cancelled."""
        self.share = done / max(total, 1)
        if self.cancelled.is_set():
            raise _Cancelled("The fit was cancelled.")

    def _show(self, result: Fit) -> list[Message]:
        """Give the sliders the fitted values, unless another model is shown by now."""
        application, session = self.application, self.session
        with session.lock:
            application.states.keep_fit(self.label, result)
            if session.state["model"] != self.label:
                return []
            session.change(to_state(result.rgb))
            state = session.describe_state()
            return [state, *application.describe_model(session.state)]


def describe_progress(label: str, share: float | None) -> Message:
    """Return the message "busy" of a fit; without a label it ends."""
    text = f"{label} is fitted" if label else ""
    progress = {"type": "busy", "task": "fit", "text": text, "fraction": share}
    return progress | {"can_cancel": True}, []
