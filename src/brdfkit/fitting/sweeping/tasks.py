"""A task: the fits of several models to one file, as a pure function of plain data.

A process of this machine and a worker of a cluster run the same function, `fit_models`. What it
takes and gives can be sent anywhere; only the files must be there, by the same paths.
"""

import io
from collections.abc import Iterator
from dataclasses import dataclass, field

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import sha256
from brdfkit.core.version import __version__
from brdfkit.fitting.fit import fit
from brdfkit.fitting.settings import FitSettings
from brdfkit.fitting.sweeping.judging import Judge
from brdfkit.materials.formats import fit_json
from brdfkit.materials.loading import load
from brdfkit.materials.resolve import to_measured
from brdfkit.model import labels


@dataclass(frozen=True)
class Task:
    """A file, and the models to fit to it.

    `material`: its name in tables, unlike all others; `file`: as the user named it; `path`: what
    `load` takes for it anywhere; `checksums`: the SHA-256 of the file by its path; `models`: the
    same of the user's files that define a model, by its label; `settings`: all those of a fit;
    `judge`: whether each fit is judged where it was not fitted and by a picture; `failure`: why the
    file cannot be read, if so; `version`: of brdfkit.
    """

    material: str
    file: str
    path: str
    checksums: dict[str, str]
    models: dict[str, dict[str, str]]
    settings: FitSettings
    judge: bool = False
    failure: str = ""
    version: str = __version__


@dataclass(frozen=True)
class Outcome:
    """What became of one fit: `text`, the fit as brdfkit saves it, or `failure`, a sentence.

    `judged`: of a task that judges, numbers by their names in `Row`.
    """

    material: str
    model: str
    text: str = ""
    failure: str = ""
    judged: dict[str, float] = field(default_factory=dict)


def fit_models(task: Task) -> Iterator[Outcome]:
    """Yield the `Outcome` of each model of a task, in their order; no error stops the others."""
    try:
        data = _read(task)
        judge = Judge(data, task.settings) if task.judge else None
    except Exception as error:
        yield from (fail(task, label, error) for label in task.models)
        return
    for label, files in task.models.items():
        try:
            _require_unchanged(files)
            for path in files:
                labels.load_model_file(path)
            stream = io.BytesIO()
            found = fit(data, label, **vars(task.settings))
            fit_json.write(found, stream)
            judged = judge.judge(found) if judge else {}
            yield Outcome(task.material, label, text=stream.getvalue().decode(), judged=judged)
        except Exception as error:
            yield fail(task, label, error)


def fail(task: Task, label: str, error: Exception | str) -> Outcome:
    """The `Outcome` of a fit that ended with an error; its sentence names the file."""
    if isinstance(error, Exception) and not isinstance(error, BrdfkitError):
        error = f"{label} fails with {type(error).__name__} ({error})."
    said = str(error)
    for path in (task.path, *task.checksums):
        said = said.replace(path, task.file)
    said = said if task.file in said else f"{task.file}: {said}"
    return Outcome(task.material, label, failure=said)


def _read(task):
    """The measured material of a task, if it is the one for which the task was made."""
    if task.failure:
        raise BrdfkitError(task.failure)
    if task.version != __version__:
        raise BrdfkitError(
            f"the worker has brdfkit {__version__} and the sweep {task.version}; install the same."
        )
    _require_unchanged(task.checksums)
    return to_measured(load(task.path))


def _require_unchanged(checksums):
    """Raise `BrdfkitError` unless the files have the SHA-256 `checksums`, by path."""
    for path, checksum in checksums.items():
        if sha256(path) != checksum:
            raise BrdfkitError(f"{path}: has changed since the sweep began; begin it again.")
