"""Keeps the fits of a sweep in a folder, each with what identifies it, and finds them again.

`FOLDER/MATERIAL/MODEL.json` is a fit as `save` writes it, with two more entries; `load` reads it.
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

KEY, JUDGED = "sweep", "judged"  # the entries


def keep(folder: Path, task: Task, outcome: Outcome) -> Path:
    """Write a finished fit into `folder`, whole or not at all; the file's path."""
    file = _path(folder, task, outcome.model)
    record = {**json.loads(outcome.text), KEY: _identity(task, outcome.model)}
    if task.judge:
        record[JUDGED] = {name: None if isnan(v) else v for name, v in outcome.judged.items()}
    make_folder(file.parent)
    with write_safely(file) as beside:
        beside.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    return file


def find(folder: Path, task: Task, label: str) -> tuple[Fit, Path, dict[str, float]] | None:
    """The fit of a model in `folder`, its file and how it was judged, None unless it is just the
    fit of the `task`."""
    file = _path(folder, task, label)
    if not task.checksums or not file.is_file():
        return None
    try:
        data = read_bytes(file)
        record = json.loads(data)
        if record.get(KEY) == _identity(task, label) and (JUDGED in record or not task.judge):
            judged = record.get(JUDGED, {}) if task.judge else {}
            judged = {name: nan if v is None else float(v) for name, v in judged.items()}
            return fit_json.read(Source(file, None, data)), file, judged
    # Damaged, or a file of somebody else's
    except (BrdfkitError, ValueError, TypeError, AttributeError):
        pass
    return None


def parse(outcome: Outcome) -> Fit:
    """The `Fit` of an outcome without failure."""
    path = Path(f"{outcome.model}.json")  # for messages
    return fit_json.read(Source(path, None, outcome.text.encode()))


def _path(folder, task, label):
    return to_fit_path(folder / task.material, label)


def _identity(task: Task, label: str) -> Any:
    """What a fit depends on, as JSON gives it back: if any of it changes, it is another fit."""
    identity = {
        "file": [[sum_, task.path.removeprefix(path)] for path, sum_ in task.checksums.items()],
        "model": label,
        "model's files": list(task.models[label].values()),
        "settings": vars(task.settings),
        "brdfkit": task.version,
    }
    return json.loads(json.dumps(identity, default=str))
