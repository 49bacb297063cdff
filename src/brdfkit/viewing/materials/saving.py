"""Files of a view of a material: its picture, its settings, its fit, the model and its errors."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_file_stem
from brdfkit.core.progress_bar import Progress
from brdfkit.materials.loading import save
from brdfkit.model import Model
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
OF_FITS = "fit", "errors", "report"  # which a model alone never has


def list_kinds(application: Application) -> dict[str, str]:
    """Return the labels of what can ever be saved of a view, by kind."""
    fittable = application.states.is_fittable
    return {kind: label for kind, label in KINDS.items() if fittable or kind not in OF_FITS}


def make_file(application: Application, session: Session, kind: str) -> Message:
    """Return the message "file" of a kind of `KINDS`, but for those of `TASKS`."""
    if kind in picture_files.KINDS:
        return picture_files.make_picture_file(application, session, kind)
    if kind not in KINDS:
        raise BrdfkitError(f"A view is saved as {', '.join(KINDS)}, and not as {kind!r:.20}.")
    states, label = application.states, session.state["model"]
    if kind == "errors":
        return _make_table_file(application, session)
    if label not in states.fits:
        raise BrdfkitError(f"{label} is not fitted yet; choose Fit first.")
    file = {"name": f"{_name_model(application, label)}.json", "mime": "application/json"}
    return {"type": "file"} | file, [_write(states.fits[label], "fit.json")]


def _name_model(application: Application, label: str) -> str:
    """Return the name of a file of a model, without its suffix."""
    measured = application.states.measured
    return to_file_stem(label if measured is None else f"{application.name}-{label}")


def _write(thing: Fit | Model, name: str) -> bytes:
    """Return the content of a file of a material, whose name has the suffix of the format."""
    with make_folder() as folder:
        path = Path(folder) / name
        save(thing, path)
        return path.read_bytes()


def make_bsdf(application: Application, session: Session) -> Iterator[list[Message]]:
    """Return the task that tabulates the model as it is shown, which takes long for some."""
    model, label = application.states.to_model(session.state), session.state["model"]
    file = {"name": f"{_name_model(application, label)}.bsdf", "mime": "application/octet-stream"}
    text = f"Tabulating {label} for Mitsuba …"
    return _make_aside(lambda _: _write(model, "model.bsdf"), text, file)


def make_report(application: Application, session: Session) -> Iterator[list[Message]]:
    """Return the task that makes the report of the view's fits; raise `BrdfkitError` for none."""
    fits = find_fits(application.states, session.state)
    if not fits:
        raise BrdfkitError("A report is about fits; choose Fit first.")
    measured = application.states.measured

    def write(progress: Progress) -> bytes:
        with make_folder() as folder:
            path = Path(folder) / "report.html"
            report(measured, fits, path=path, spp=SAMPLES, progress=progress)
            return path.read_bytes()

    text = "Making the report, with path-traced pictures …"
    name = f"{to_file_stem(application.name)}-report.html"
    return _make_aside(write, text, {"name": name, "mime": "text/html"})


def _make_aside(
    write: Callable[[Progress], bytes], text: str, file: dict[str, str]
) -> Iterator[list[Message]]:
    """Make a file in a thread; yields messages for the page, with `text`, and the file at last."""
    work = Background(write)
    busy: dict[str, Any] = {"type": "busy", "task": "save", "text": text, "can_cancel": True}
    yield from work.follow(lambda: (busy | {"fraction": work.share or None}, []))
    yield [(busy | {"text": "", "fraction": None}, [])]
    if work.result is None:
        yield [describe_error(work.error or BrdfkitError(""))]
    else:
        yield [({"type": "file"} | file, [work.result])]


TASKS = {"bsdf": make_bsdf, "report": make_report}  # of files that take long


def find_fits(states: Any, state: State) -> list[Fit]:
    """Return the fits that are pinned, and those of the models that are not."""
    pinned = [
        next(
            (
                fit
                for _, fit in list(states.kept[states.mends].all)
                if has_values(fit, pin["values"])
            ),
            None,
        )
        for pin in state["pins"]
    ]
    fits = [*filter(None, pinned), *list(states.fits.values())]
    return list({fit.rgb: fit for fit in fits}.values())


def _make_table_file(application: Application, session: Session) -> Message:
    """Return the message "file" of the table of errors."""
    if not list_rows(application.states, session.state):
        raise BrdfkitError("There are no errors yet; choose Fit or Pin first.")
    content = write_csv(application.states, session.state).encode()
    name = f"{to_file_stem(application.name)}-errors.csv"
    return {"type": "file", "name": name, "mime": "text/csv"}, [content]
