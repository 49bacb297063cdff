"""`sweep`: models fitted to many materials, past bad files, on from where another one ended."""

import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

from brdfkit.core.arguments import to_dictionary, to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import make_folder, require_writable
from brdfkit.fitting.fit import check_settings
from brdfkit.fitting.sweeping import saved_fits
from brdfkit.fitting.sweeping.cluster import count_slots, run_on_cluster
from brdfkit.fitting.sweeping.planning import plan, split
from brdfkit.fitting.sweeping.processes import default_workers, run_in_processes
from brdfkit.fitting.sweeping.result import Row, Sweep
from brdfkit.fitting.sweeping.tasks import Outcome, Task, fail, fit_models
from brdfkit.model import Model
from brdfkit.regression import Fit
from brdfkit.regression.solvers.settings import require_plain

TABLE, PAGE = "table.csv", "index.html"  # files of the output


def sweep(
    files: str | Path | Iterable[str | Path],
    models: str | Path | type[Model] | Iterable[str | Path | type[Model]],
    settings: Mapping[str, Any] | None = None,
    *,
    output: str | Path | None = None,
    judge: bool = False,
    workers: int | None = None,
    client: Any = None,
    progress: Callable[[int, int], object] | None = None,
) -> Sweep:
    """Fit several models to many materials, in several processes or on a cluster.

    A file that cannot be read, or a fit that fails, does not stop the others. Where a process dies,
    its fit is tried again once. Ctrl-C ends with the fits that are finished.

    Parameters
    ----------
    files : str, Path or several
        The measured files, or names of materials that brdfkit knows.
    models : str, Path, class or several
        The models, as for `fit`; one of your own is named by its file, or its class comes from one.
    settings : dict of str to object, optional
        The other arguments of `fit` by name, as ``{"loss": "cbrt", "robust": "bisquare"}``.
    output : str or Path, optional
        A folder, to which each fit is saved as soon as it is finished; at the end the table
        ``table.csv`` and the page ``index.html``. Fits that an earlier sweep saved there are read
        and not repeated, unless their file, their settings or brdfkit's version changed.
    judge : bool, default False
        Whether to tell of each fit, too, its error in directions that were held out and the PSNR of
        its picture, as `rank` does. This takes about as long again.
    workers : int, optional
        How many processes; by default one for each core, as far as the memory goes.
    client : distributed.Client, optional
        A cluster that fits in place of processes. The paths of the files must lead to them there,
        too.
    progress : callable, optional
        Called with (done, total) before the first and after each fit; those that were saved do not
        count.

    Returns
    -------
    Sweep
        A row for each fit; prints as a table of errors.

    Raises
    ------
    BrdfkitError
        For an unknown model or setting, where there is no file or no model, for an output that is
        no folder, and for what is no client.

    Examples
    --------
    >>> print(sweep(Path("merl").glob("*.binary"), ["ward", "ggx"]))    # doctest: +SKIP
    """
    began = time.perf_counter()
    settings = check_settings(to_dictionary("settings", settings))
    require_plain(settings["solver"], settings["constraints"])
    slots = _count_slots(workers, client)
    tasks = [replace(task, judge=bool(judge)) for task in plan(files, models, settings)]
    folder = None if output is None else Path(output)
    if folder:
        make_folder(folder)
        for name in (TABLE, PAGE):
            require_writable(folder / name)

    # What is saved, and what is left to do
    rows = {key: row for task in tasks for key, row in _find_rows(task, folder)}
    left = [_without(task, rows) for task in tasks]
    found, total = len(rows), sum(len(task.models) for task in left)

    # The fits, each saved as it comes
    report = progress or (lambda done, total: None)
    named = {task.material: task for task in tasks}
    try:
        report(0, total)
        with closing(_run([task for task in left if task.models], slots, client)) as outcomes:
            for outcome in outcomes:
                task = named[outcome.material]
                rows[outcome.material, outcome.model] = _finish(task, outcome, folder)
                report(len(rows) - found, total)
    except KeyboardInterrupt:
        for task in tasks:  # Ctrl-C may come between the saving of a fit and its row
            rows.update(_find_rows(_without(task, rows), folder))
        if not rows:
            raise

    keys = [(task.material, label) for task in tasks for label in task.models]
    finished = tuple(rows[key] for key in keys if key in rows)
    done = Sweep(finished, len(keys), found, time.perf_counter() - began)
    if folder and done.fits:
        done.to_csv(folder / TABLE)
        done.to_html(folder / PAGE)
    return done


def _count_slots(workers: int | None, client: Any) -> int:
    """How many tasks are done at once."""
    if client is None:
        return default_workers() if workers is None else to_whole_number("workers", workers, 1)
    if workers is not None:
        raise BrdfkitError("A cluster has workers of its own; give either workers or a client.")
    return count_slots(client)


def _run(tasks: list[Task], slots: int, client: Any) -> Generator[Outcome, None, None]:
    """Yield the outcomes of tasks as they come; the files that cannot be read come first."""
    readable = [task for task in tasks if not task.failure]
    for task in tasks:
        if task.failure:
            yield from fit_models(task)
    parts = split(readable, slots)
    yield from run_in_processes(parts, slots) if client is None else run_on_cluster(parts, client)


def _find_rows(task: Task, folder: Path | None) -> Iterator[tuple[tuple[str, str], Row]]:
    """Yield the rows, with their keys, of those fits of a task that are saved in `folder`."""
    for label in task.models:
        if folder and (saved := saved_fits.find(folder, task, label)):
            yield (task.material, label), _make_row(task, label, *saved)


def _without(task: Task, rows: Mapping[tuple[str, str], Row]) -> Task:
    """A task without the models that have a row."""
    models = {n: files for n, files in task.models.items() if (task.material, n) not in rows}
    return replace(task, models=models)


def _finish(task: Task, outcome: Outcome, folder: Path | None) -> Row:
    """The row of an outcome, whose fit is saved in `folder`."""
    try:
        fit = None if outcome.failure else saved_fits.parse(outcome)
    except BrdfkitError as error:
        outcome, fit = fail(task, outcome.model, error), None
    if fit is None:
        loss = task.settings["loss"]
        return Row(task.material, task.file, outcome.model, loss, message=outcome.failure)
    saved = saved_fits.keep(folder, task, outcome) if folder else None
    return _make_row(task, outcome.model, fit, saved, outcome.judged)


def _make_row(
    task: Task, label: str, fit: Fit, saved: Path | None, judged: Mapping[str, float]
) -> Row:
    """The row of a fit that was `judged`, numbers by their names, or not."""
    values = fit.model.free_values.items()
    sought = [v for n, v in values if n not in task.settings["fixed"]]
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
