"""`sweep`: fits models to many materials, and continues where an earlier sweep ended."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

from brdfkit.core.arguments import to_dictionary, to_whole_number
from brdfkit.core.cluster import count_cluster_slots, run_tasks
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import make_folder, require_writable
from brdfkit.core.progress_bar import Progress
from brdfkit.fitting.settings import FitSettings, ModelLike, require_material_first
from brdfkit.fitting.sweeping import saved_fits
from brdfkit.fitting.sweeping.planning import plan_tasks, split_tasks
from brdfkit.fitting.sweeping.processes import choose_worker_count, run_in_processes
from brdfkit.fitting.sweeping.result import Row, Sweep
from brdfkit.fitting.sweeping.tasks import Outcome, Task, fit_models, fit_task, make_failed_outcome
from brdfkit.regression import Fit
from brdfkit.regression.solvers.settings import require_plain_data

TABLE, PAGE = "table.csv", "index.html"  # names of the files that summarise a folder


def sweep(
    materials: str | Path | Iterable[str | Path],
    models: ModelLike | Iterable[ModelLike],
    *,
    settings: Mapping[str, Any] | None = None,
    folder: str | Path | None = None,
    judge: bool = False,
    workers: int | None = None,
    client: Any = None,
    progress: Progress | None = None,
) -> Sweep:
    """Fit several models to many materials, in several processes or on a cluster.

    A file that cannot be read and a fit that fails do not stop the others. If a process dies, its
    fit is tried once more. Ctrl-C ends with the fits that are finished.

    Parameters
    ----------
    materials : str, Path or several
        The measured materials: their files, or their names.
    models : str, Path, class or several
        The models, as for `fit`. A model of your own is given by its file, or by a class that was
        loaded from one.
    settings : dict of str to object, optional
        The other arguments of `fit` by name, as ``{"loss": "cbrt", "robust": "bisquare"}``.
    folder : str or Path, optional
        A folder in which each fit is saved as soon as it is finished, and at the end the table
        ``table.csv`` and the page ``index.html``. Fits that an earlier sweep saved there are read
        and not repeated, unless their file, their settings or brdfkit's version changed.
    judge : bool, default False
        Whether to compute for each fit its error in held-out directions and the PSNR of its
        picture, as in `rank`. This doubles the time.
    workers : int, optional
        Number of processes; by default one for each core, as far as the memory suffices.
    client : distributed.Client, optional
        A cluster that fits in place of local processes. The paths of the files must be valid there,
        too.
    progress : callable, optional
        Called with (fits done, fits in all) before the first and after each fit; fits that an
        earlier sweep saved do not count.

    Returns
    -------
    Sweep
        A row for each fit; prints as a table of errors.

    Raises
    ------
    BrdfkitError
        For an unknown model or setting, without a file or a model, for a `folder` that is no
        folder, and for a `client` that is no `distributed.Client`.

    Examples
    --------
    >>> print(sweep(Path("merl").glob("*.binary"), ["ward", "ggx"]))    # doctest: +SKIP
    """
    began = time.perf_counter()
    checked = FitSettings.from_dictionary(to_dictionary("settings", settings))
    require_plain_data(checked.solver, checked.constraints)
    slots = _count_task_slots(workers, client)
    tasks = [replace(task, judge=bool(judge)) for task in plan_tasks(materials, models, checked)]
    require_material_first("sweep(materials, models)", materials)
    folder = None if folder is None else Path(folder)
    if folder:
        make_folder(folder)
        for name in (TABLE, PAGE):
            require_writable(folder / name)

    # Read the fits that an earlier sweep saved, so that only the others are fitted
    rows = {key: row for task in tasks for key, row in _find_saved_rows(task, folder)}
    left = [_remove_finished_models(task, rows) for task in tasks]
    found, total = len(rows), sum(len(task.models) for task in left)

    # Save each fit as soon as it is finished, so that Ctrl-C loses none
    report = progress or (lambda done, total: None)
    named = {task.material: task for task in tasks}
    try:
        report(0, total)
        with closing(_run_tasks([task for task in left if task.models], slots, client)) as outcomes:
            for outcome in outcomes:
                task = named[outcome.material]
                rows[outcome.material, outcome.model] = _save_outcome(task, outcome, folder)
                report(len(rows) - found, total)
    except KeyboardInterrupt:
        for task in tasks:  # Ctrl-C may come after a fit is saved and before its row is stored
            rows.update(_find_saved_rows(_remove_finished_models(task, rows), folder))
        if not rows:
            raise

    keys = [(task.material, label) for task in tasks for label in task.models]
    finished = tuple(rows[key] for key in keys if key in rows)
    done = Sweep(finished, len(keys), found, time.perf_counter() - began)
    if folder and done.fits:
        done.to_csv(folder / TABLE)
        done.to_html(folder / PAGE)
    return done


def _count_task_slots(workers: int | None, client: Any) -> int:
    """Return how many tasks run at a time, on this machine or on the cluster of a `client`."""
    if client is None:
        return choose_worker_count() if workers is None else to_whole_number("workers", workers, 1)
    if workers is not None:
        raise BrdfkitError("A cluster has workers of its own; give either workers or a client.")
    return count_cluster_slots(client)


def _run_tasks(tasks: list[Task], slots: int, client: Any) -> Generator[Outcome, None, None]:
    """Yield the outcomes of tasks as they are finished; failures of unreadable files come first."""
    readable = [task for task in tasks if not task.failure]
    for task in tasks:
        if task.failure:
            yield from fit_models(task)
    parts = split_tasks(readable, slots)
    yield from run_in_processes(parts, slots) if client is None else _fit_on_cluster(parts, client)


def _fit_on_cluster(tasks: list[Task], client: Any) -> Iterator[Outcome]:
    """Yield the outcomes of tasks as the cluster of a `client` finishes them."""
    runs = run_tasks(
        fit_task,
        tasks,
        client,
        describe=lambda task: f"{task.file}: {', '.join(task.models)}",
        divide=lambda task: [replace(task, models={n: f}) for n, f in task.models.items()],
    )
    with closing(runs):
        for task, found in runs:
            if isinstance(found, Exception):
                found = [make_failed_outcome(task, label, found) for label in task.models]
            yield from found


def _find_saved_rows(task: Task, folder: Path | None) -> Iterator[tuple[tuple[str, str], Row]]:
    """Yield the key (material, model) and the row of every fit of a task that `folder` contains."""
    for label in task.models:
        if folder and (saved := saved_fits.find_saved_fit(folder, task, label)):
            yield (task.material, label), _make_row(task, label, *saved)


def _remove_finished_models(task: Task, rows: Mapping[tuple[str, str], Row]) -> Task:
    """Return the task without the models that already have a row."""
    models = {n: files for n, files in task.models.items() if (task.material, n) not in rows}
    return replace(task, models=models)


def _save_outcome(task: Task, outcome: Outcome, folder: Path | None) -> Row:
    """Save the fit of an outcome in `folder`, if one is given, and return its row."""
    try:
        fit = None if outcome.failure else saved_fits.parse_fit(outcome)
    except BrdfkitError as error:
        outcome, fit = make_failed_outcome(task, outcome.model, error), None
    if fit is None:
        loss = task.settings.loss
        return Row(task.material, task.file, outcome.model, loss, message=outcome.failure)
    saved = saved_fits.save_fit(folder, task, outcome) if folder else None
    return _make_row(task, outcome.model, fit, saved, outcome.judged)


def _make_row(
    task: Task, label: str, fit: Fit, saved: Path | None, judged: Mapping[str, float]
) -> Row:
    """Return the row of a fit; `judged` contains its held-out error and PSNR, if any, by name."""
    values = fit.model.free_values.items()
    sought = [v for n, v in values if n not in task.settings.fixed]
    return Row(
        task.material,
        task.file,
        label,
        fit.loss_name,
        error=fit.loss,
        seconds=fit.seconds,
        parameters=sum(len(v) if isinstance(v, tuple) else 1 for v in sought),
        samples=fit.samples,
        at_bounds=fit.at_bounds,
        message=fit.message,
        fit=fit,
        saved=saved,
        **judged,
    )
