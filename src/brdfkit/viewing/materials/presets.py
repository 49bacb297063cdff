"""Presets: values of a model that are its fit to a material which comes with brdfkit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from brdfkit.core.catalogue import list_materials
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.progress_bar import Progress
from brdfkit.fitting.fit import fit
from brdfkit.viewing.application import Message
from brdfkit.viewing.background import Background
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.parameter_state import to_state
from brdfkit.viewing.pictures import describe_error

FIRST, FITTED = "", "fit"  # the names of presets that are first values, and those of the last fit


def list_presets() -> list[list[str]]:
    """Return the name and the title of each preset."""
    shipped = [[name, f"fit to {name}"] for name in list_materials()]
    return [[FIRST, "first values"], [FITTED, "values of its last fit"], *shipped]


def answer_preset(session: Any, message: dict[str, Any]) -> list[Message]:
    """Give the model that is shown the values of a preset, or begin to compute them."""
    name, label = message.get("name"), session.state["model"]
    states = session.application.states
    if name == FIRST:
        return _show(session, label, to_state(type(states.find_model(label))()))
    if name == FITTED:
        if label not in states.fits:
            raise BrdfkitError(f"{label} is not fitted yet; choose Fit first.")
        return _show(session, label, to_state(states.fits[label].rgb))
    if name not in list_materials():
        raise no_such_error("preset", name, list_materials())
    if (label, name) in session.application.presets:
        return _show(session, label, session.application.presets[label, name])
    session.tasks.append(_fit(session, label, str(name)))
    return []


def _fit(session: Any, label: str, name: str) -> Iterator[list[Message]]:
    """Fit a model to a material; yields messages for the page, and shows the fit at last."""
    model = type(session.application.states.find_model(label))

    def find_values(progress: Progress) -> State:
        return to_state(fit(name, model, progress=progress).rgb)

    work = Background(find_values)
    text = f"Fitting {label} to {name} …"
    busy: dict[str, Any] = {"type": "busy", "task": "preset", "text": text, "can_cancel": True}
    yield from work.follow(lambda: (busy | {"fraction": work.share or None}, []))
    end: Message = busy | {"text": "", "fraction": None}, []
    if work.result is None:
        yield [end, describe_error(work.error or BrdfkitError(""))]
        return
    session.application.presets[label, name] = work.result
    yield [*_show(session, label, work.result), end]


def _show(session: Any, label: str, values: State) -> list[Message]:
    """Give the sliders values, unless another model is shown by now."""
    with session.lock:
        if session.state["model"] != label:
            return []
        answers: list[Message] = session.handle({"type": "set", "changes": values})
        return answers
