"""Makes the tasks of a sweep from files, models and settings, and divides them among workers."""

import math
import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import compute_sha256
from brdfkit.core.names import make_unique, to_file_stem
from brdfkit.fitting.settings import FitSettings
from brdfkit.fitting.sweeping.tasks import Task
from brdfkit.materials.formats import Source
from brdfkit.materials.loading import locate_material
from brdfkit.model import Model, labels

PARTS = 4  # least number of tasks for each worker: with fewer, some would finish much earlier


def plan_tasks(files: Any, models: Any, settings: FitSettings) -> list[Task]:
    """Return one task for every file, with all models; duplicate files and models count once.

    `files` and `models` are one or several each, and `settings` are those of all fits. A task with
    an unreadable file contains the reason. Raises `BrdfkitError` if a model is unknown, or if there
    is no file or no model.
    """
    classes = [labels.model(labels.load_files_in_label(m)) for m in _require_list(models, "model")]
    defined = {c.label(): _compute_model_checksums(c) for c in classes}
    tasks: dict[str, Task] = {}
    for file in _require_list(files, "file"):
        task = _plan_task_for_file(file, defined, settings)
        if task.path not in tasks:
            taken = {t.material for t in tasks.values()}
            tasks[task.path] = replace(task, material=make_unique(task.material, taken))
    return list(tasks.values())


def split_tasks(tasks: list[Task], workers: int) -> list[Task]:
    """Divide the models of `tasks` among more tasks if there are too few for the `workers`."""
    parts = math.ceil(PARTS * workers / max(1, len(tasks)))
    return [part for task in tasks for part in _split_task(task, parts)]


def _split_task(task: Task, parts: int) -> Iterator[Task]:
    """Divide the models of a task among up to `parts` tasks."""
    models = list(task.models.items())
    size = math.ceil(len(models) / parts)
    for start in range(0, len(models), size):
        yield replace(task, models=dict(models[start : start + size]))


def _plan_task_for_file(
    file: Any, models: dict[str, dict[str, str]], settings: FitSettings
) -> Task:
    """Return the task for one file, or for one material that is known by name."""
    if not isinstance(file, str | Path):
        raise BrdfkitError(
            f"A sweep takes files and names of materials, not a {type(file).__name__}; save it "
            "first, as by brdfkit.save(material, 'FILE.npz')."
        )
    file = str(file)
    try:
        path, sample = locate_material(file)
        checksum = compute_sha256(path)
    except BrdfkitError as error:
        return Task(
            _name_material(Path(file)), file, file, {}, models, settings, failure=str(error)
        )
    suffix = "" if sample is None else f"#{sample}"
    whole = str(path.absolute())
    return Task(
        _name_material(path, suffix), file, whole + suffix, {whole: checksum}, models, settings
    )


def _name_material(path: Path, suffix: str = "") -> str:
    """Return a name for the material in a file that is also valid as the name of a folder."""
    return to_file_stem(Source(path, None, b"").name + suffix)


def _compute_model_checksums(model: type[Model]) -> dict[str, str]:
    """Return the SHA-256 of each user's file that defines a model, by path."""
    checksums = {}
    for part in model.made_of():
        if not part.is_in_plugin_file():
            raise BrdfkitError(
                f"{part.__name__} is defined in no file of its own, which other processes could "
                "load; write it to one and name that."
            )
        if part.__module__.rpartition(".")[0] == plugin_files.USERS:
            path = str(sys.modules[part.__module__].__file__)
            checksums[path] = compute_sha256(path)
    return checksums


def _require_list(things: Any, what: str) -> list[Any]:
    """Return one or several things as a list; raise `BrdfkitError` if there is none."""
    several = isinstance(things, Iterable) and not isinstance(things, str)
    items = list(things) if several else [things]
    if not items:
        raise BrdfkitError(f"There is no {what} here; give at least one.")
    return items
