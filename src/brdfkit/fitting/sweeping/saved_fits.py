"""Saves the fits of a sweep in a folder, and finds them again when the sweep is repeated.

`FOLDER/MATERIAL/MODEL.json` contains a fit as `save` writes it, so that `load` can read it, and two
more entries: everything that the fit depends on, and its held-out error and PSNR.
"""

import json
from math import isnan, nan
from pathlib import Path
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import make_folder, read_bytes, write_safely
from brdfkit.core.names import to_fit_path
from brdfkit.fitting.sweeping.tasks import Outcome, Task
from brdfkit.materials.formats import Source, fit_json
from brdfkit.regression import Fit

KEY, JUDGED = "sweep", "judged"  # names of the two entries that a sweep adds to a fit's file


def save_fit(folder: Path, task: Task, outcome: Outcome) -> Path:
    """Write a finished fit into `folder`, completely or not at all, and return the file's path."""
    file = _find_fit_path(folder, task, outcome.model)
    record = {**json.loads(outcome.text), KEY: _describe_dependencies(task, outcome.model)}
    if task.judge:
        record[JUDGED] = {name: None if isnan(v) else v for name, v in outcome.judged.items()}
    make_folder(file.parent)
    with write_safely(file) as beside:
        beside.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    return file


def find_saved_fit(
    folder: Path, task: Task, label: str
) -> tuple[Fit, Path, dict[str, float]] | None:
    """Find the saved fit of the model `label` in `folder`.

    Return the fit, its file, and its held-out error and PSNR, if any, by name. Return None unless
    the fit was saved with the same measured file, settings and versions as the `task` has.
    """
    file = _find_fit_path(folder, task, label)
    if not task.checksums or not file.is_file():
        return None
    try:
        data = read_bytes(file)
        record = json.loads(data)
        if record.get(KEY) == _describe_dependencies(task, label) and (
            JUDGED in record or not task.judge
        ):
            judged = record.get(JUDGED, {}) if task.judge else {}
            judged = {name: nan if v is None else float(v) for name, v in judged.items()}
            return fit_json.read(Source(file, None, data)), file, judged
    # The file is damaged, or no sweep wrote it
    except (BrdfkitError, ValueError, TypeError, AttributeError):
        pass
    return None


def parse_fit(outcome: Outcome) -> Fit:
    """Return the `Fit` of an outcome that is no failure."""
    path = Path(f"{outcome.model}.json")  # appears only in error messages
    return fit_json.read(Source(path, None, outcome.text.encode()))


def _find_fit_path(folder: Path, task: Task, label: str) -> Path:
    """Return the path in `folder` of the saved fit of the model `label`."""
    return to_fit_path(folder / task.material, label)


def _describe_dependencies(task: Task, label: str) -> Any:
    """Return everything that a fit depends on, as JSON; if it changes, the fit is repeated."""
    identity = {
        "file": [[sum_, task.path.removeprefix(path)] for path, sum_ in task.checksums.items()],
        "model": label,
        "model's files": list(task.models[label].values()),
        "settings": vars(task.settings),
        "brdfkit": task.version,
    }
    return json.loads(json.dumps(identity, default=str))
