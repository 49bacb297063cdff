"""Answers to a page about its pins: to pin the model that is shown, to show a pin, and errors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.application import Message
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.error_table import describe_errors
from brdfkit.viewing.materials.fit_marks import describe_fit
from brdfkit.viewing.materials.pins import add_pin, find_pin, has_values, select_values

if TYPE_CHECKING:
    from brdfkit.viewing.session import Session

    Application = Any  # `MaterialApplication`, which imports this file


def pin(session: Session, message: dict[str, Any]) -> list[Message]:
    """Pin the model that is shown, with its values."""
    state, states = session.state, _find_application(session).states
    label, values = state["model"], select_values(state)
    fit = states.fits.get(label)
    loss = fit.loss_name if fit is not None and has_values(fit, values) else ""
    return _change(session, {"pins": add_pin(state["pins"], label, values, loss)})


def show(session: Session, message: dict[str, Any]) -> list[Message]:
    """Give the sliders the model and the values of a pin, and the marks of its fit."""
    states, found = _find_application(session).states, _require_pin(session, message)
    label, values = found["model"], found["values"]
    fits = [
        fit
        for own, fit in list(states.kept[states.mends].all)
        if own == label and has_values(fit, values)
    ]
    if fits:
        states.fits[label] = fits[-1]
    answers = _change(session, {"model": label, **values})
    described = any(answer["type"] == "fit" for answer, _ in answers)
    return answers if described else [*answers, (describe_fit(states.fits.get(label)), [])]


def show_errors(session: Session, message: dict[str, Any]) -> list[Message]:
    """Begin to compute the errors of the pins and the fits."""
    states = _find_application(session).states
    if states.is_fittable:
        session.tasks.append(describe_errors(states, session.state))
    return []


def _change(session: Session, changes: State) -> list[Message]:
    """Change the state of a session as the page does, and return the answers."""
    return session.handle({"type": "set", "changes": changes, "moving": False})


def _require_pin(session: Session, message: dict[str, Any]) -> dict[str, Any]:
    """Return the pin that a message names; raise `BrdfkitError` if there is none."""
    found = find_pin(session.state["pins"], str(message.get("pin")))
    if found is None:
        raise BrdfkitError("This pin is there no more.")
    return dict(found)


def _find_application(session: Session) -> Application:
    """Return the application of a session, which is one for materials."""
    return session.application
