"""Carries out a task of a sweep: several models are fitted to one file.

Processes of this machine and workers of a cluster run the same function, `fit_models`. Its argument
and results are plain data that can be sent to any process; the files must have the same paths
there.
"""

import io
from collections.abc import Iterator
from dataclasses import dataclass, field

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_unchanged
from brdfkit.core.version import __version__
from brdfkit.fitting.fit import fit
from brdfkit.fitting.settings import FitSettings
from brdfkit.fitting.sweeping.judging import Judge
from brdfkit.materials.formats import fit_json
from brdfkit.materials.loading import load
from brdfkit.materials.measured import Measured
from brdfkit.materials.resolve import to_measured
from brdfkit.model import labels


@dataclass(frozen=True)
class Task:
    """A file, and the models to fit to it.

    `material`: unique name of the material in tables.
    `file`: the file, as the user named it.
    `path`: the file with its full path, as `load` takes it.
    `checksums`: SHA-256 of the file by its path, to notice changes.
    `models`: for each model's label, the SHA-256 of the user's files that define it, by path.
    `settings`: the settings of all fits.
    `judge`: whether to compute a held-out error and a PSNR of each fit.
    `failure`: the reason why the file cannot be read, or "".
    `version`: the version of brdfkit that made the task.
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
    """The result of one fit: its saved form in `text`, or the reason of its `failure`.

    `judged` contains its held-out error and PSNR by their names in `Row`, if the task asks for
    them.
    """

    material: str
    model: str
    text: str = ""
    failure: str = ""
    judged: dict[str, float] = field(default_factory=dict)


def fit_models(task: Task) -> Iterator[Outcome]:
    """Fit the models of a task in order, and yield the `Outcome` of each, even if it fails."""
    try:
        data = _read_measurement(task)
        judge = Judge(data, task.settings) if task.judge else None
    except Exception as error:
        yield from (make_failed_outcome(task, label, error) for label in task.models)
        return
    for label, files in task.models.items():
        try:
            require_unchanged(files)
            for path in files:
                labels.load_model_file(path)
            stream = io.BytesIO()
            result = fit(data, label, **vars(task.settings))
            fit_json.write(result, stream)
            judged = judge.judge_fit(result) if judge else {}
            yield Outcome(task.material, label, text=stream.getvalue().decode(), judged=judged)
        except Exception as error:
            yield make_failed_outcome(task, label, error)


def fit_task(_shared: None, task: Task) -> list[Outcome]:
    """Return the outcomes of a task; this is what the worker of a cluster calls."""
    return list(fit_models(task))


def make_failed_outcome(task: Task, label: str, error: Exception | str) -> Outcome:
    """Return the `Outcome` of a fit that ended with an error; its message names the file."""
    if isinstance(error, Exception) and not isinstance(error, BrdfkitError):
        error = f"{label} fails with {type(error).__name__} ({error})."
    message = str(error)
    for path in (task.path, *task.checksums):
        message = message.replace(path, task.file)
    message = message if task.file in message else f"{task.file}: {message}"
    return Outcome(task.material, label, failure=message)


def _read_measurement(task: Task) -> Measured:
    """Read the measured material of a task; raise `BrdfkitError` if file or version has changed."""
    if task.failure:
        raise BrdfkitError(task.failure)
    if task.version != __version__:
        raise BrdfkitError(
            f"the worker has brdfkit {__version__} and the sweep {task.version}; install the same."
        )
    require_unchanged(task.checksums)
    return to_measured(load(task.path))
