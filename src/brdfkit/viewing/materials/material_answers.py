"""The answers to the messages of a page that are about its material."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

from brdfkit.core.arguments import to_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.application import Message, unknown_message_error
from brdfkit.viewing.difference_map import compare_colours
from brdfkit.viewing.materials import about, material_scripts, pin_answers, presets, saving
from brdfkit.viewing.materials.audit_panel import begin_audit
from brdfkit.viewing.materials.fit_task import FitTask
from brdfkit.viewing.materials.picture_controls import FILE, MODEL
from brdfkit.viewing.session import Session


def answer(application: Any, session: Session, message: dict[str, Any]) -> list[Message]:
    """Answer a message that is about the material; raise `BrdfkitError` for an unknown one.

    `application` is the `MaterialApplication` of the session.
    """
    kind = str(message.get("type"))
    if kind not in ANSWERS:
        raise unknown_message_error(kind)
    return ANSWERS[kind](application, session, message)


def begin_fit(application: Any, session: Session, message: dict[str, Any]) -> list[Message]:
    """Begin to fit the model that is shown, or all models."""
    if not application.states.is_fittable:
        raise BrdfkitError(f"{application.name} was not measured, so nothing can be fitted to it.")
    if application.fitting() in session.tasks:
        raise BrdfkitError("A fit goes on already; wait for it, or cancel it.")
    if session.state["second"] == FILE:
        session.change({"second": MODEL})
    task = FitTask(application, session, bool(message.get("all")))
    steps = task.run()
    application.fitting = weakref.ref(steps)  # the fit ends as soon as the session forgets it
    session.tasks.insert(0, steps)  # before the errors of other fits
    return [session.describe_state(), task.describe_progress()]


def probe(application: Any, session: Session, message: dict[str, Any]) -> list[Message]:
    """Return the linear RGB of each picture under the pointer, and how their colours differ."""
    x, y = (min(max(to_number(name, message.get(name)), 0.0), 1.0) for name in "xy")
    (pictures, colours), state = session.sent, session.sent_state
    texts, places = [], []
    for side, picture in sorted(pictures.items()):
        height, width = picture.shape[:2]
        at = min(int(y * height), height - 1), min(int(x * width), width - 1)
        value = " ".join(f"{v:.3g}" for v in picture[at])
        texts.append(f"{application.describe_side(state, side)['name']}: {value}")
        places.append(colours[side][at])
    if len(places) > 1:
        texts.append(f"ΔE {compare_colours(*places):.2g}")
    return [({"type": "probe", "text": "RGB of " + " · ".join(texts) if texts else ""}, [])]


def save(application: Any, session: Session, message: dict[str, Any]) -> list[Message]:
    """Return a file for the page to keep; one that takes long comes later."""
    kind = str(message.get("kind"))
    if kind in saving.TASKS:
        session.tasks.append(saving.TASKS[kind](application, session))
        return []
    return [saving.make_file(application, session, kind)]


def copy(application: Any, session: Session, message: dict[str, Any]) -> list[Message]:
    """Return the view as a script, a command or Mitsuba's XML."""
    kinds = material_scripts.KINDS
    title, write = kinds.get(str(message.get("kind")), kinds["python"])
    return [({"type": "text", "title": title, "text": write(application, session)}, [])]


ANSWERS: dict[str, Callable[[Any, Session, dict[str, Any]], list[Message]]] = {
    "probe": probe,
    "audit": lambda application, session, _: begin_audit(application, session),
    "fit": begin_fit,
    "pin": lambda _, session, message: pin_answers.pin(session, message),
    "show_pin": lambda _, session, message: pin_answers.show(session, message),
    "errors": lambda _, session, message: pin_answers.show_errors(session, message),
    "preset": lambda _, session, message: presets.answer_preset(session, message),
    "about": lambda _, session, message: [about.describe_models(session.state["model"])],
    "save": save,
    "copy": copy,
}
