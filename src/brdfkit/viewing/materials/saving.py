"""Files of a view of a material: its picture, its settings, its fit, the model and its errors."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_file_stem
from brdfkit.materials.loading import save
from brdfkit.viewing import picture_files
from brdfkit.viewing.materials.error_table import list_rows, write_csv
from brdfkit.viewing.temporary_folders import make_folder

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.session import Session

    Application = Any  # `MaterialApplication`, which imports this file

KINDS = {
    **picture_files.KINDS,
    "fit": "Fit (JSON)",
    "bsdf": "Model as shown (Mitsuba's .bsdf)",
    "errors": "Table of errors (CSV)",
}


def make_file(application: Application, session: Session, kind: str) -> Message:
    """Return the message "file" of a kind of `KINDS`."""
    if kind in picture_files.KINDS:
        return picture_files.make_picture_file(application, session, kind)
    if kind not in KINDS:
        raise BrdfkitError(f"A view is saved as {', '.join(KINDS)}, and not as {kind!r:.20}.")
    states, label = application.states, session.state["model"]
    if kind == "errors":
        return _make_table_file(application, session)
    if kind == "fit" and label not in states.fits:
        raise BrdfkitError(f"{label} is not fitted yet; choose Fit first.")
    thing = states.fits[label] if kind == "fit" else states.to_model(session.state)
    suffix, mime = (".json", "application/json") if kind == "fit" else (".bsdf", "")
    name = to_file_stem(f"{application.name}-{label}" if states.measured else label) + suffix
    with make_folder() as folder:
        path = Path(folder) / f"material{suffix}"
        save(thing, path)
        content = path.read_bytes()
    mime = mime or "application/octet-stream"
    return {"type": "file", "name": name, "mime": mime}, [content]


def _make_table_file(application: Application, session: Session) -> Message:
    """Return the message "file" of the table of errors."""
    if not list_rows(application.states, session.state):
        raise BrdfkitError("There are no errors yet; choose Fit or Pin first.")
    content = write_csv(application.states, session.state).encode()
    name = f"{to_file_stem(application.name)}-errors.csv"
    return {"type": "file", "name": name, "mime": "text/csv"}, [content]
