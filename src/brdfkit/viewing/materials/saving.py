"""Files of a view of a material: its picture, its settings, its fit, the model and its errors."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_file_stem
from brdfkit.core.progress_bar import Progress
from brdfkit.materials.loading import save
from brdfkit.regression import Fit
from brdfkit.reporting.report import report
from brdfkit.viewing import picture_files
from brdfkit.viewing.background import Background
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.error_table import list_rows, write_csv
from brdfkit.viewing.materials.pins import has_values
from brdfkit.viewing.pictures import describe_error
from brdfkit.viewing.temporary_folders import make_folder

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.session import Session

    Application = Any  # `MaterialApplication`, which imports this file

SAMPLES = 64  # per pixel of the pictures of a report
KINDS = {
    **picture_files.KINDS,
    "fit": "Fit (JSON)",
    "bsdf": "Model as shown (Mitsuba's .bsdf)",
    "errors": "Table of errors (CSV)",
    "report": "Report of the fits (HTML)",
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


def make_report(application: Application, session: Session) -> Iterator[list[Message]]:
    """Return the task that makes the report of the view's fits; raise `BrdfkitError` for none."""
    fits = find_fits(application.states, session.state)
    if not fits:
        raise BrdfkitError("A report is about fits; choose Fit first.")
    return _write_report(application, fits)


def _write_report(application: Application, fits: list[Fit]) -> Iterator[list[Message]]:
    """Make the report of fits; yields messages for the page, and the file at last."""
    with make_folder() as folder:
        path = Path(folder) / "report.html"

        def write(progress: Progress) -> bytes:
            report(application.states.measured, fits, path=path, spp=SAMPLES, progress=progress)
            return path.read_bytes()

        work = Background(write)
        text = "Making the report, with path-traced pictures …"
        busy = {"type": "busy", "task": "report", "text": text, "can_cancel": True}
        yield from work.follow(lambda: (busy | {"fraction": work.share or None}, []))
    yield [({"type": "busy", "task": "report", "text": "", "fraction": None}, [])]
    if work.result is None:
        yield [describe_error(work.error or BrdfkitError(""))]
    else:
        name = f"{to_file_stem(application.name)}-report.html"
        yield [({"type": "file", "name": name, "mime": "text/html"}, [work.result])]


def find_fits(states: Any, state: State) -> list[Fit]:
    """Return the fits that are pinned, and those of the models that are not."""
    pinned = [
        next((fit for _, fit in states.all_fits if has_values(fit, pin["values"])), None)
        for pin in state["pins"]
    ]
    fits = [*filter(None, pinned), *states.fits.values()]
    return list({fit.rgb: fit for fit in fits}.values())


def _make_table_file(application: Application, session: Session) -> Message:
    """Return the message "file" of the table of errors."""
    if not list_rows(application.states, session.state):
        raise BrdfkitError("There are no errors yet; choose Fit or Pin first.")
    content = write_csv(application.states, session.state).encode()
    name = f"{to_file_stem(application.name)}-errors.csv"
    return {"type": "file", "name": name, "mime": "text/csv"}, [content]
