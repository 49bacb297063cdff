"""Runs tasks on a cluster of `dask.distributed`, and repeats those whose worker died.

The workers call one function with what all tasks share and with one task. Both are sent as pickles
that only a worker opens (`Parcel`), so that the scheduler copies bytes and imports no models. What
is shared is itself a task of the cluster, unless it is small: it goes to each worker once, and if
the last worker that has it dies, the scheduler makes it again.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar
from uuid import uuid4

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import compute_sha256, require_unchanged
from brdfkit.core.jit.threads import in_turn, set_thread_count
from brdfkit.core.version import __version__

T = TypeVar("T")
# Configuration of Dask: the size of a task from which a client warns. What tasks share may be large
WARNING = "distributed.admin.large-graph-warning-threshold"
SMALL = 10_000  # bytes: what tasks share is sent with each of them if it is not longer


@dataclass(eq=False)
class Parcel:
    """An object in pickled form, for another process with the same version of brdfkit.

    `data`: the pickle. `checksums`: SHA-256 of files that belong to it, by path. `version`: the
    version of brdfkit that made it.
    """

    data: bytes
    checksums: dict[str, str]
    version: str = __version__

    @classmethod
    def pack(cls, content: Any, files: Iterable[Path] = ()) -> Parcel:
        """Pickle `content`, to which `files` belong; raise `BrdfkitError` if that is impossible."""
        import cloudpickle

        checksums = {str(file): compute_sha256(file) for file in files}
        try:
            return cls(cloudpickle.dumps(content), checksums)
        except Exception as error:  # an object may raise anything when it is pickled
            raise BrdfkitError(
                f"client: this cannot be sent to a cluster ({error}); leave client out."
            ) from error

    @in_turn
    def open(self) -> Any:
        """Return the object, which is made at the first call only.

        Raises `BrdfkitError` for another version of brdfkit, and if one of the files, or that of a
        user's model, is missing here or has changed.
        """
        if self.version != __version__:
            raise BrdfkitError(
                f"the worker has brdfkit {__version__} and the client {self.version}; install the "
                "same."
            )
        if "content" not in vars(self):
            import cloudpickle

            require_unchanged(self.checksums)
            with warnings.catch_warnings():
                warnings.filterwarnings("error", ".*has changed since the model")
                try:
                    self.content = cloudpickle.loads(self.data)
                except UserWarning as changed:
                    raise BrdfkitError(f"On a worker of the cluster: {changed}") from None
        return self.content

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "content"}


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
            "'pip install brdfkit[cluster]' brings it."
        )
    return max(1, sum(client.nthreads().values()))


def run_tasks(
    function: Callable[[Any, T], Any],
    tasks: Sequence[T],
    client: Any,
    *,
    shared: Any = None,
    files: Iterable[Path] = (),
    describe: Callable[[T], str] = str,
    divide: Callable[[T], Iterable[T]] = lambda task: [task],
) -> Generator[tuple[T, Any], None, None]:
    """Yield (task, result) for all tasks, as soon as the cluster of a `client` has finished them.

    A result is what `function(shared, task)` returns in a worker, or the exception that it raises.
    `function` belongs to a module; `files` are those that it reads, at the same absolute paths in
    all workers; `describe` returns a task's name for messages. Without a client the tasks run here,
    in their order, and exceptions are raised.

    If a worker dies, another one repeats its tasks, as often as the cluster allows. The cluster
    counts this for every task of a dead worker, although only one of them killed it. So a task that
    it gives up is cut into parts by `divide`, and these are tried once more at the end, one after
    the other. The result of a part that even then ends all its workers is a `BrdfkitError`. When
    the generator is closed, tasks that have not begun are cancelled.
    """
    if client is None:
        for task in tasks:
            yield task, function(shared, task)
        return
    import dask
    from distributed import KilledWorker, as_completed

    run = uuid4().hex[:8]

    def submit(task: T, number: int) -> Any:
        """Send a task to the scheduler; those with a small `number` begin first."""
        key = (f"{function.__name__}-{run}", f"{number}: {describe(task)}")
        # The scheduler mixes tasks that arrive within a tenth of a second, unless it knows better
        options = {"key": key, "priority": -number}
        with dask.config.set({WARNING: "1 TB"}):
            return client.submit(_call_on_worker, function, kept, Parcel.pack(task), **options)

    kept: Any = Parcel.pack(shared, files)
    if len(kept.data) > SMALL:
        with dask.config.set({WARNING: "1 TB"}):
            kept = client.submit(_return_parcel, kept, key=(f"shared-{run}", ""))
        # Otherwise all tasks would be given to the one worker that has it
        client.replicate([kept], n=max(1, min(len(tasks), len(client.nthreads()))))
    waiting = {submit(task, number): task for number, task in enumerate(tasks)}
    suspects: list[T] = []
    try:
        for future in as_completed(waiting):
            task = waiting.pop(future)
            try:
                result = future.result()
            except KilledWorker:
                suspects += divide(task)
            except Exception as error:
                yield task, explain_loss(error, describe(task))
            else:
                yield task, result
        for number, task in enumerate(suspects, start=len(tasks)):
            future = submit(task, number)
            waiting[future] = task
            try:
                result = future.result()
            except Exception as error:
                result = explain_loss(error, describe(task))
            yield waiting.pop(future), result
    finally:
        if waiting:
            client.cancel(list(waiting))


def explain_loss(error: Exception, name: str) -> Exception:
    """Return the error for people if the cluster lost the task `name`; otherwise `error` itself."""
    from distributed import CancelledError, KilledWorker

    if isinstance(error, KilledWorker):
        return BrdfkitError(f"{name} ended every worker that tried it; see the workers' logs.")
    if isinstance(error, CancelledError):
        return BrdfkitError(f"{name} was dropped by the cluster; see whether its scheduler runs.")
    return error


def require_result(result: Any) -> Any:
    """Return the result of a task, or raise it if it is an exception."""
    if isinstance(result, Exception):
        raise result
    return result


def _return_parcel(parcel: Parcel) -> Parcel:
    """Return a parcel as it is, so that it becomes a result that workers keep and exchange."""
    return parcel


def _call_on_worker(function: Callable[[Any, Any], Any], shared: Parcel, task: Parcel) -> Any:
    """Call `function(shared, task)` in a thread of a worker of the cluster."""
    from distributed import get_worker

    set_thread_count(get_worker().state.nthreads)
    return function(shared.open(), task.open())
