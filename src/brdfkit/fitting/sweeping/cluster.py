"""Runs tasks on a cluster, by a client of `dask.distributed`."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import use_threads
from brdfkit.fitting.sweeping.tasks import Outcome, Task, fail, fit_models


def count_slots(client: Any) -> int:
    """How many tasks a cluster does at once; `BrdfkitError` where `client` is no client of one."""
    try:
        from distributed import Client
    except ImportError:
        Client = ()
    if not isinstance(client, Client) or client.asynchronous:
        raise BrdfkitError(
            f"client = {client!r} should be a dask.distributed.Client, and no asynchronous one; "
            "'pip install distributed' brings it."
        )
    return max(1, sum(client.nthreads().values()))


def run_on_cluster(tasks: list[Task], client: Any) -> Iterator[Outcome]:
    """Yield the outcomes of tasks, as they come from the cluster of a `client`.

    A task whose worker dies is done again by another one, as often as the cluster allows. Then its
    fits are tried one at a time, after all others: those that a worker had at hand when it died
    count as its cause, though only one of them was.
    """
    from distributed import KilledWorker, as_completed

    waiting = {client.submit(fit_task, task): task for task in tasks}
    suspects: list[Task] = []
    try:
        for future in as_completed(waiting):
            task = waiting.pop(future)
            if isinstance(future.exception(), KilledWorker):
                suspects += [replace(task, models={n: f}) for n, f in task.models.items()]
            else:
                yield from _outcomes(future, task)
        for task in suspects:
            future = client.submit(fit_task, task, pure=False)
            waiting[future] = task
            yield from _outcomes(future, task)
    finally:
        client.cancel(list(waiting))


def _outcomes(future, task):
    """The outcomes of a task, once its future is done."""
    from distributed import KilledWorker

    try:
        return future.result()
    except KilledWorker:
        why = "ended every worker that tried it; see the workers' logs."
        return [fail(task, label, f"{label} {why}") for label in task.models]
    except Exception as error:  # the cluster is gone, or dropped the task
        return [fail(task, label, error) for label in task.models]


def fit_task(task: Task) -> list[Outcome]:
    """The outcomes of a task, in a thread of a cluster's worker."""
    from distributed import get_worker

    use_threads(get_worker().state.nthreads)
    return list(fit_models(task))
