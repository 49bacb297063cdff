"""Answers the messages of the page that are about a volume."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from brdfkit.core.arguments import to_number, to_whole_number
from brdfkit.viewing.application import unknown_message_error
from brdfkit.viewing.controls import State
from brdfkit.viewing.volumes import saving, scripts, slices
from brdfkit.viewing.volumes.painting import paint
from brdfkit.viewing.volumes.pointer import find_visible_voxel
from brdfkit.volumes import Volume
from brdfkit.volumes.orientation import PLANES

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.session import Session

    Application = Any  # `VolumeApplication`, which imports this file


def answer(application: Application, session: Session, message: dict[str, Any]) -> list[Message]:
    """Answer a message; raise `BrdfkitError` for an unknown one."""
    kind = str(message.get("type"))
    if kind not in ANSWERS:
        raise unknown_message_error(kind)
    return ANSWERS[kind](application, session, message)


def show_slices(volume: Volume, before: State, after: State) -> list[Message]:
    """Return the message with the slices if they are shown and have changed."""
    if not after["show.slices"]:
        return []
    drawn_by = "show.slices", "slices.low", "slices.high"
    drawn = all(before.get(name) == after[name] for name in drawn_by)
    window, shown = (after["slices.low"], after["slices.high"]), before.get("slices")
    planes, pictures = slices.draw_slices(volume, after["slices"], window, shown if drawn else None)
    return [({"type": "slices", "planes": planes}, pictures)] if planes else []


def _probe(application: Application, session: Session, message: dict[str, Any]) -> list[Message]:
    """Return the value of the first voxel that is visible under the pointer."""
    place = np.clip([to_number(name, message.get(name)) for name in "xy"], 0, 1)
    state, (width, height) = session.state, session.size
    shown = application.states.of_side(
        state, int(bool(state["second"]) and place[0] > state["wipe"])
    )
    table, extinction = application.states.find_opacities(shown)
    at = find_visible_voxel(
        application.states.live,
        application.states.camera(state),
        place,
        width / height,
        state["clip"],
        table,
        extinction,
        shown["renderer"] == "maximum_intensity",
    )
    text = (
        ""
        if at is None
        else slices.describe_voxel(application.volume, at, application.states.value_unit)
    )
    return [({"type": "probe", "text": text, "voxel": at}, [])]


def _paint(application: Application, session: Session, message: dict[str, Any]) -> list[Message]:
    """Change the transfer function by a stroke, as one undo step."""
    width, height = session.size
    hide = bool(message.get("hide"))
    changes = paint(application.states, session.state, message.get("stroke"), width / height, hide)
    return session.handle({"type": "set", "changes": changes, "moving": False})


def _probe_slice(
    application: Application, session: Session, message: dict[str, Any]
) -> list[Message]:
    """Return the value of the voxel under the pointer in a slice."""
    plane = to_whole_number("plane", message.get("plane"), 0, len(PLANES) - 1)
    x, y = (to_number(name, message.get(name)) for name in "xy")
    at = slices.move_crosshair(application.volume, session.state["slices"], plane, x, y)
    text = slices.describe_voxel(application.volume, at, application.states.value_unit)
    return [({"type": "probe", "text": text, "voxel": at}, [])]


def _save(application: Application, session: Session, message: dict[str, Any]) -> list[Message]:
    """Return a file for the page to keep."""
    return [saving.make_file(application, session, str(message.get("kind")))]


def _copy(application: Application, session: Session, message: dict[str, Any]) -> list[Message]:
    """Return the view as a script or a command."""
    kind = str(message.get("kind"))
    write = scripts.write_command if kind == "command" else scripts.write_script
    title = "The same picture from a command" if kind == "command" else "The same from Python"
    return [({"type": "text", "title": title, "text": write(application, session)}, [])]


ANSWERS: dict[str, Callable[[Any, Any, dict[str, Any]], list[Any]]] = {
    "probe": _probe,
    "probe_slice": _probe_slice,
    "save": _save,
    "copy": _copy,
    "paint": _paint,
}
