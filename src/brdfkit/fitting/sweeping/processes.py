"""Run the tasks of a sweep in processes of this machine, so that a crash costs only one fit.

Processes are spawned, not forked, because Dr.Jit's threads do not survive a fork. Each process
receives tasks through a pipe and sends every fit back as soon as it is finished.
`ProcessPoolExecutor` does not fit: the death of one process ends its whole pool, and it does not
report which fit the process was working on.
"""

import multiprocessing
import os
import signal
import sys
from collections import Counter, deque
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from types import ModuleType
from typing import Any

import psutil

from brdfkit.core.interrupts import hold_signals
from brdfkit.core.jit.threads import use_threads
from brdfkit.fitting.sweeping.tasks import Outcome, Task, fail, fit_models

MEMORY = 10**9  # bytes for each process; fitting a MERL table takes 0.55 GB
LIVES = 2  # processes that may die during one fit before it counts as failed
THREADS = "OMP_NUM_THREADS"  # environment variable that NumPy reads when it is imported


@dataclass
class Worker:
    """A process and the pipe to it.

    `task` is the task that the process works on, None if it is idle, and `left` lists the models
    of that task whose outcomes it has not sent yet.
    """

    process: BaseProcess
    pipe: Connection
    task: Task | None = None
    left: list[str] = field(default_factory=list)

    def give(self, task: Task) -> None:
        """Send a task to the process."""
        self.task, self.left = task, list(task.models)
        with suppress(OSError):  # the process has died; the next read of the pipe reports it
            self.pipe.send(task)

    def receive(self) -> Outcome:
        """Receive the next outcome; raises EOFError or OSError if the process has died."""
        outcome = self.pipe.recv()
        self.left.remove(outcome.model)
        self.task = self.task if self.left else None
        return outcome

    def end(self) -> int:
        """Kill the process, if it is still alive, and return its exit code."""
        self.pipe.close()
        self.process.kill()
        self.process.join()
        return self.process.exitcode or 0


def default_workers() -> int:
    """Return how many processes the cores and the memory of this machine allow."""
    return int(max(1, min(_count_cores(), psutil.virtual_memory().available // MEMORY)))


def run_in_processes(tasks: list[Task], workers: int) -> Iterator[Outcome]:
    """Yield the outcomes of tasks in the order in which up to `workers` processes finish them.

    If a process dies during a fit, a new process tries the fit once more; then the fit counts as
    failed. The processes end with the generator.
    """
    workers = min(workers, len(tasks))
    waiting, deaths = deque(tasks), Counter[tuple[str, str]]()
    crew: list[Worker] = []
    try:
        while waiting or any(worker.task for worker in crew):
            idle = [worker for worker in crew if not worker.task]
            while waiting and (idle or len(crew) < workers):
                if not idle:
                    idle.append(_start_worker(threads=max(1, _count_cores() // workers)))
                    crew.append(idle[0])
                idle.pop().give(waiting.popleft())
            busy: dict[Any, Worker] = {worker.pipe: worker for worker in crew if worker.task}
            for pipe in wait(
                list(busy), timeout=1
            ):  # Ctrl-C in another thread does not interrupt it
                worker = busy[pipe]
                try:
                    outcome = worker.receive()
                except (EOFError, OSError):
                    crew.remove(worker)
                    yield from _replace_dead_worker(worker, waiting, deaths)
                else:
                    yield outcome
    finally:
        for worker in crew:
            worker.end()


def _replace_dead_worker(
    worker: Worker, waiting: deque[Task], deaths: Counter[tuple[str, str]]
) -> Iterator[Outcome]:
    """Return the unfinished fits of a dead worker to the `waiting` tasks.

    `deaths` counts dead processes by material and model. If the fit that killed the worker has
    killed `LIVES` processes, its failure is yielded and the fit is not repeated.
    """
    worker.process.join(timeout=5)  # the pipe closes before the process has ended
    task, label, code = worker.task, worker.left[0], worker.end()
    assert task is not None  # only busy workers are read from
    deaths[task.material, label] += 1
    if deaths[task.material, label] == LIVES:
        how = signal.Signals(-code).name if code < 0 else f"exit status {code}"
        yield fail(
            task,
            label,
            f"{label} ended its process {LIVES} times ({how}); give fewer workers if memory is "
            "short.",
        )
        worker.left.remove(label)
    if worker.left:
        waiting.appendleft(replace(task, models={n: task.models[n] for n in worker.left}))


def _start_worker(threads: int) -> Worker:
    """Start a process whose Dr.Jit kernels use `threads` threads, and return its `Worker`."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, threads), daemon=True)
    with (
        hold_signals(),
        _prepare_for_spawn(),
    ):  # an interrupted start would leave a process without tasks
        process.start()
    theirs.close()
    return Worker(process, ours)


@contextmanager
def _prepare_for_spawn() -> Iterator[None]:
    """Set up the block so that its new processes use one NumPy thread and ignore Ctrl-C.

    The main module is hidden from them: they would import a script that sweeps, and sweep again.
    """
    main, old_threads = sys.modules["__main__"], os.environ.get(THREADS)
    masked = None
    if hasattr(signal, "pthread_sigmask"):
        resource_tracker.ensure_running()  # its start would unmask Ctrl-C
        masked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    sys.modules["__main__"] = ModuleType("__main__")
    os.environ.setdefault(THREADS, "1")
    try:
        yield
    finally:
        sys.modules["__main__"] = main
        if old_threads is None:
            del os.environ[THREADS]
        if masked is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, masked)


def _work(pipe: Connection, threads: int) -> None:
    """Carry out tasks from the `pipe`, one after another, until it is closed; runs in a process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    use_threads(threads)
    with suppress(EOFError, OSError):
        while True:
            for outcome in fit_models(pipe.recv()):
                pipe.send(outcome)


def _count_cores() -> int:
    """Return how many processor cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
