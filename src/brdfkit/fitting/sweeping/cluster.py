"""Runs the tasks of a sweep on a cluster, through a client of `dask.distributed`."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import set_thread_count
from brdfkit.fitting.sweeping.tasks import Outcome, Task, fit_models, make_failed_outcome


def count_cluster_slots(client: Any) -> int:
    """Return how many tasks the cluster of a `client` runs at the same time.

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

    If a worker dies, another worker repeats its tasks, as often as the cluster allows. The cluster
    counts this for every task of a dead worker, although only one of them killed it. Tasks that are
    given up are therefore divided into single fits, which run one after the other at the end.
    """
    from distributed import KilledWorker, as_completed

    waiting = {client.submit(fit_on_worker, task): task for task in tasks}
    suspects: list[Task] = []
    try:
        for future in as_completed(waiting):
            task = waiting.pop(future)
            if isinstance(future.exception(), KilledWorker):
                suspects += [replace(task, models={n: f}) for n, f in task.models.items()]
            else:
                yield from _wait_for_outcomes(future, task)
        for task in suspects:
            future = client.submit(fit_on_worker, task, pure=False)
            waiting[future] = task
            yield from _wait_for_outcomes(future, task)
    finally:
        client.cancel(list(waiting))


def _wait_for_outcomes(future: Any, task: Task) -> list[Outcome]:
    """Wait for the `future` of a task, and return its outcomes, or failures if it was lost."""
    from distributed import KilledWorker

    try:
        return future.result()
    except KilledWorker:
        why = "ended every worker that tried it; see the workers' logs."
        return [make_failed_outcome(task, label, f"{label} {why}") for label in task.models]
    except Exception as error:  # the cluster has shut down or dropped the task
        return [make_failed_outcome(task, label, error) for label in task.models]


def fit_on_worker(task: Task) -> list[Outcome]:
    """Carry out a task in a thread of a worker of the cluster, and return its outcomes."""
    from distributed import get_worker

    set_thread_count(get_worker().state.nthreads)
    return list(fit_models(task))
