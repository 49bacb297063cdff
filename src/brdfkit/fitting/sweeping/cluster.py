"""Run the tasks of a sweep on a cluster, through a client of `dask.distributed`."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import use_threads
from brdfkit.fitting.sweeping.tasks import Outcome, Task, fail, fit_models


def count_slots(client: Any) -> int:
    """Return how many tasks the cluster of a `client` runs at once.

    Raises `BrdfkitError` if `client` is not a synchronous `distributed.Client`.
    """
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
    """Yield the outcomes of tasks in the order in which the cluster of a `client` finishes them.

    If a worker dies, another worker repeats its task, as often as the cluster allows. After that,
    the fits of the task run one at a time, after all other tasks: the cluster blames every task
    that a dead worker held, although only one of them killed it.
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
                yield from _wait_for_outcomes(future, task)
        for task in suspects:
            future = client.submit(fit_task, task, pure=False)
            waiting[future] = task
            yield from _wait_for_outcomes(future, task)
    finally:
        client.cancel(list(waiting))


def _wait_for_outcomes(future: Any, task: Task) -> list[Outcome]:
    """Wait for the `future` of a task and return the outcomes, failures if the task was lost."""
    from distributed import KilledWorker

    try:
        return future.result()
    except KilledWorker:
        why = "ended every worker that tried it; see the workers' logs."
        return [fail(task, label, f"{label} {why}") for label in task.models]
    except Exception as error:  # the cluster has shut down or dropped the task
        return [fail(task, label, error) for label in task.models]


def fit_task(task: Task) -> list[Outcome]:
    """Carry out a task in a thread of a cluster's worker and return its outcomes."""
    from distributed import get_worker

    use_threads(get_worker().state.nthreads)
    return list(fit_models(task))
