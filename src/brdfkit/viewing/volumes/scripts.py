"""Scripts and commands that repeat the picture of a view."""

from __future__ import annotations

import json
import shlex
from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.controls import State

if TYPE_CHECKING:
    from brdfkit.viewing.session import Session

    Application = Any  # `VolumeApplication`, which imports this file

SAMPLES = 64  # per pixel at least
# Names that a preset sets
PRESET = "transfer.mode", "transfer.points", "transfer.extinction", "transfer.colour"


def write_script(application: Application, session: Session) -> str:
    """Return a Python script that makes the session's picture."""
    changes, source = find_changes(application, session.state), application.source
    if source is None:
        load = "volume"
    else:
        words = [repr(source.path), *(f"{k}={v!r}" for k, v in source.settings.items())]
        load = f"brdfkit.volumes.load({', '.join(words)})"
    lines = [f"    {name!r}: {value!r}," for name, value in changes.items()]
    state = "{\n" + "\n".join(lines) + "\n}" if lines else "{}"
    return (
        f"{_write_comments(application, changes)}"
        "import brdfkit\n\n"
        f"state = {state}\n"
        f"picture = brdfkit.viewing.render_view({load}, state, size={session.picture_size()}, "
        f"spp={max(session.passes, SAMPLES)})\n"
        f"picture.write({application.volume.name + '.png'!r})\n"
    )


def write_command(application: Application, session: Session) -> str:
    """Return a command that makes the session's picture."""
    changes, source = find_changes(application, session.state), application.source
    if source is None:
        raise BrdfkitError(
            "This volume was made in Python, and no command can load it; copy Python."
        )
    settings = dict(source.settings)
    labels = settings.pop("labels", None)
    if settings.keys() - {"downsample"}:
        raise BrdfkitError("A command cannot say how raw voxels are stored; copy Python.")
    width, height = session.picture_size()
    words = ["brdfkit", "view", source.path]
    words += [word for k, v in settings.items() for word in (f"--{k}", str(v))]
    words += [] if labels is None else ["--labels" if labels else "--no-labels"]
    words += ["--state", json.dumps(changes), "--size", f"{width}x{height}"]
    words += ["--spp", str(max(session.passes, SAMPLES)), "-o", f"{application.volume.name}.png"]
    return _write_comments(application, changes) + shlex.join(words)


def find_changes(application: Application, state: State) -> State:
    """Return what of a state differs from the first one of the volume."""
    states = application.states
    first = states.first()
    changes = {name: value for name, value in state.items() if value != first[name]}
    if state["labels"] != application.loaded.labels:
        changes["labels"] = state["labels"]
    if any(name.startswith("transfer.") for name in changes):
        changes["transfer.mode"] = state["transfer.mode"]  # other changes may alter it
    if "transfer.preset" in changes:
        # These may be as in the first state, but a preset would change them
        changes |= {name: state[name] for name in PRESET}
        if state["transfer.mode"] != "preset":
            del changes["transfer.preset"]
    return changes


def _write_comments(application: Application, changes: State) -> str:
    """Return a comment for each file that the page sent, whose folder is unknown."""
    states, source = application.states, application.source
    names = [source.path] if source is not None and source.uploaded else []
    sent = {"light.environment": states.environments, "transfer.preset": states.functions.files}
    names += [changes[k] for k, known in sent.items() if k in changes and changes[k] in known]
    return "".join(f"# Write the folder of {n} before its name; the page hides it\n" for n in names)
