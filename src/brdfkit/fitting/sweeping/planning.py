"""Makes tasks of files, models and settings, and cuts them where there are few."""

import math
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import sha256
from brdfkit.core.names import make_unique, to_file_stem
from brdfkit.fitting.settings import FitSettings
from brdfkit.fitting.sweeping.tasks import Task
from brdfkit.materials.formats import Source
from brdfkit.materials.loading import locate
from brdfkit.model import Model, labels

PARTS = 4  # tasks a worker, at least, where there are so many fits: then all end at about one time


def plan(files: Any, models: Any, settings: FitSettings) -> list[Task]:
    """A task for every file, with all models; a file or a model that is named twice counts once.

    `files`, `models`: one or several; `settings`: those of all fits. A file that cannot be read
    has a task with its failure. Raises `BrdfkitError` for what is no model, and where there is no
    file or no model.
    """
    classes = [labels.model(labels.load_files(m)) for m in _as_list(models, "model")]
    defined = {c.label(): _checksums_of_files(c) for c in classes}
    tasks: dict[str, Task] = {}
    for file in _as_list(files, "file"):
        task = _plan_file(file, defined, settings)
        if task.path not in tasks:
            taken = {t.material for t in tasks.values()}
            tasks[task.path] = replace(task, material=make_unique(task.material, taken))
    return list(tasks.values())


def split(tasks: list[Task], workers: int) -> list[Task]:
    """`tasks`, with their models cut into parts where there are too few tasks for the workers."""
    parts = math.ceil(PARTS * workers / max(1, len(tasks)))
    return [part for task in tasks for part in _cut(task, parts)]


def _cut(task, parts):
    models = list(task.models.items())
    size = math.ceil(len(models) / parts)
    for start in range(0, len(models), size):
        yield replace(task, models=dict(models[start : start + size]))


def _plan_file(file: Any, models: dict[str, dict[str, str]], settings: FitSettings) -> Task:
    """The task of one file, or of a material that is known by name."""
    if not isinstance(file, str | Path):
        raise BrdfkitError(
            f"A sweep takes files and names of materials, not a {type(file).__name__}; save it "
            "first, as by brdfkit.save(material, 'FILE.npz')."
        )
    file = str(file)
    try:
        path, sample = locate(file)
        checksum = sha256(path)
    except BrdfkitError as error:
        return Task(_name(Path(file)), file, file, {}, models, settings, failure=str(error))
    behind = "" if sample is None else f"#{sample}"
    whole = str(path.absolute())
    return Task(_name(path, behind), file, whole + behind, {whole: checksum}, models, settings)


def _name(path, behind=""):
    """The name of a file's material, fit for a folder: the file's without suffix; `behind`: it."""
    return to_file_stem(Source(path, None, b"").name + behind)


def _checksums_of_files(model: type[Model]) -> dict[str, str]:
    """The SHA-256 by path of the user's files that define a model."""
    found = {}
    for part in model.made_of():
        if not part.is_in_plugin_file():
            raise BrdfkitError(
                f"{part.__name__} is defined in no file of its own, which other processes could "
                "load; write it to one and name that."
            )
        if part.__module__.rpartition(".")[0] == plugin_files.USERS:
            path = str(sys.modules[part.__module__].__file__)
            found[path] = sha256(path)
    return found


def _as_list(things: Any, what: str) -> list[Any]:
    """One or several things as a list; an error where there are none."""
    several = isinstance(things, Iterable) and not isinstance(things, str)
    found = list(things) if several else [things]
    if not found:
        raise BrdfkitError(f"There is no {what} here; give at least one.")
    return found
