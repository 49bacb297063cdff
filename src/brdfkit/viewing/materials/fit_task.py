"""`FitTask`: fits that a page asked for, which the page can follow and cancel."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import join_words
from brdfkit.core.progress_bar import Progress
from brdfkit.fitting.fit import fit
from brdfkit.regression import Fit
from brdfkit.viewing.application import Message
from brdfkit.viewing.background import Background, Cancelled
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.error_table import describe_errors
from brdfkit.viewing.materials.fit_settings import to_fit_arguments, was_made_with
from brdfkit.viewing.materials.parameter_state import to_state
from brdfkit.viewing.materials.pins import COLOURS, add_pin
from brdfkit.viewing.pictures import describe_error

if TYPE_CHECKING:
    from brdfkit.viewing.materials.material_state import MaterialState
    from brdfkit.viewing.session import Session

USUAL_MODELS = "ggx", "ward", "ggx+ggx"  # fitted by "Fit all" where a page has used only one
WAITS = "Waiting for the end of the fit before …"
END: Message = {"type": "busy", "task": "fit", "text": "", "fraction": None, "can_cancel": True}, []


def choose_labels(states: MaterialState) -> list[str]:
    """Return the labels of the models that "Fit all" fits: those of the page, or usual ones."""
    used = list(dict.fromkeys([*states.models, *states.fits]))
    used = used if len(used) > 1 else list(dict.fromkeys([*used, *USUAL_MODELS]))
    given = [*states.given][: len(COLOURS)]
    others = [label for label in used if label not in given]
    return [*given, *others[len(given) - len(COLOURS) :]] if len(given) < len(COLOURS) else given


class FitTask:
    """Fits with the page's settings: of the model that a session shows, or of all, which it pins.

    They are made in a thread of their own, so that the task of the session only waits for it. It
    begins when a fit that was cancelled before has ended.
    """

    def __init__(self, application: Any, session: Session, fits_all: bool = False) -> None:
        self.application, self.session, self.fits_all = application, session, fits_all
        self.state = dict(session.state)
        own = [self.state["model"]]
        self.labels = choose_labels(application.states) if fits_all else own
        self.background = Background(self._fit_each)
        self.waits = application.fit_turn.locked()  # by a fit that was cancelled
        self.results: dict[str, Fit] = {}
        self.errors: dict[str, Exception] = {}

    def run(self) -> Iterator[list[Message]]:
        """Fit the models, and show the fits; yields messages for the page."""
        yield from self.background.follow(self.describe_progress)
        if self.results:
            yield self._show()
        yield [END, *self._describe_failures()]

    def _fit_each(self, report: Progress) -> None:
        """Fit the models, and keep the fits and the errors."""
        with self.application.fit_turn:
            report(0, 1)  # it may be cancelled by now
            self.waits = False
            for label in self.labels:
                self.background.share = 0.0
                try:
                    self.results[label] = self._fit(label, report)
                except Cancelled:
                    raise
                except Exception as error:  # of this model; the others may go well
                    self.errors[label] = error

    def _fit(self, label: str, report: Progress) -> Fit:
        """Fit a model with the settings of the page."""
        states, is_shown = self.application.states, label == self.state["model"]
        model = type(states.find_model(label))
        how = to_fit_arguments(self.state, model, is_shown)
        kept = states.fits.get(label) if self.fits_all else None
        if kept is not None and was_made_with(kept, states.measured, how):
            return kept
        return fit(states.measured, model, **how, progress=report)

    def describe_progress(self) -> Message:
        """Return the message "busy", without a share before the first step."""
        number = min(len(self.results) + len(self.errors), len(self.labels) - 1)
        several = f" ({number + 1} of {len(self.labels)})" if len(self.labels) > 1 else ""
        share = (number + self.background.share) / len(self.labels)
        text = f"Fitting {self.labels[number]} …{several}" if not self.waits else WAITS
        return END[0] | {"text": text, "fraction": share or None}, []

    def _show(self) -> list[Message]:
        """Pin all fits if several were asked for, and give the sliders the fitted values.

        The sliders stay as they are if another model is shown by now. The errors follow, because
        those of large measurements take a while.
        """
        application, session = self.application, self.session
        with session.lock:
            if application.fitting() not in session.tasks:
                return []  # it was cancelled just now
            changes: State = {}
            for label, result in self.results.items():
                application.states.keep_fit(label, result)
                if label == session.state["model"]:
                    changes |= to_state(result.rgb)
            if self.fits_all:
                changes["pins"] = self._pin(session.state["pins"])
            session.change(changes)
            session.tasks.append(describe_errors(application.states, session.state))
            return [session.describe_state(), *application.describe_model(session.state)]

    def _pin(self, pins: list[Any]) -> list[Any]:
        """Return the pins with the fits; those of the same models give way if there are too many.

        A fit is left out where there is no room even so.
        """
        for label, result in self.results.items():
            if len(pins) == len(COLOURS):
                same = [pin for pin in pins if pin["model"] == label and pin["loss"]]
                pins = [pin for pin in pins if pin not in same[:1]]
            if len(pins) < len(COLOURS):
                pins = add_pin(pins, label, to_state(result.rgb), result.loss_name)
        return pins

    def _describe_failures(self) -> list[Message]:
        """Return a message about the fits that failed, unless all went well."""
        if not self.errors:
            return []
        if len(self.labels) == 1:
            return [describe_error(next(iter(self.errors.values())))]
        text = join_words([f"{label}: {error}" for label, error in self.errors.items()])
        return [describe_error(BrdfkitError(f"Not every model was fitted. {text}"))]
