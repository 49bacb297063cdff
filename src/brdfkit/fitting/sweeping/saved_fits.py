"""Save the fits of a sweep in a folder, and find them again when a sweep is repeated.

`FOLDER/MATERIAL/MODEL.json` holds a fit as `save` writes it, and `load` reads it. Two more entries
hold the identity of the fit and its judgement.
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

KEY, JUDGED = "sweep", "judged"  # the names of the two entries


def keep(folder: Path, task: Task, outcome: Outcome) -> Path:
    """Write a finished fit into `folder`, completely or not at all, and return the file's path."""
    file = _path_of_fit(folder, task, outcome.model)
    record = {**json.loads(outcome.text), KEY: _identity(task, outcome.model)}
    if task.judge:
        record[JUDGED] = {name: None if isnan(v) else v for name, v in outcome.judged.items()}
    make_folder(file.parent)
    with write_safely(file) as beside:
        beside.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    return file


def find(folder: Path, task: Task, label: str) -> tuple[Fit, Path, dict[str, float]] | None:
    """Find the saved fit of the model `label` in `folder`.

    Returns the fit, its file and its judgement, or None unless the saved fit has the same file,
    settings and versions as the `task`.
    """
    file = _path_of_fit(folder, task, label)
    if not task.checksums or not file.is_file():
        return None
    try:
        data = read_bytes(file)
        record = json.loads(data)
        if record.get(KEY) == _identity(task, label) and (JUDGED in record or not task.judge):
            judged = record.get(JUDGED, {}) if task.judge else {}
            judged = {name: nan if v is None else float(v) for name, v in judged.items()}
            return fit_json.read(Source(file, None, data)), file, judged
    # A damaged file, or a file that no sweep wrote
    except (BrdfkitError, ValueError, TypeError, AttributeError):
        pass
    return None


def parse(outcome: Outcome) -> Fit:
    """Return the `Fit` of an outcome that is no failure."""
    path = Path(f"{outcome.model}.json")  # for error messages only
    return fit_json.read(Source(path, None, outcome.text.encode()))


def _path_of_fit(folder: Path, task: Task, label: str) -> Path:
    """Return the path of the file in `folder` for the fit of the model `label`."""
    return to_fit_path(folder / task.material, label)


def _identity(task: Task, label: str) -> Any:
    """Return everything that a fit depends on, as JSON; a change in it requires a new fit."""
    identity = {
        "file": [[sum_, task.path.removeprefix(path)] for path, sum_ in task.checksums.items()],
        "model": label,
        "model's files": list(task.models[label].values()),
        "settings": vars(task.settings),
        "brdfkit": task.version,
    }
    return json.loads(json.dumps(identity, default=str))
