"""Runs tasks in processes of this machine; one that dies takes no other fit with it.

A process is spawned, not forked: Dr.Jit's threads do not survive a fork. By its pipe it gets a task
and sends each fit as it is finished. `ProcessPoolExecutor` would not do: there the death of one
process ends all of them, and leaves open of which fit it died.
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

MEMORY = 10**9  # bytes for a process; to fit a MERL table takes 0.55 GB
LIVES = 2  # so many processes may die of one fit
THREADS = "OMP_NUM_THREADS"  # of NumPy, which reads it as it is imported


@dataclass
class Worker:
    """A process and its pipe; `task`: what it works on, None if on nothing; `left`: the models of
    the task whose outcomes it has not sent."""

    process: BaseProcess
    pipe: Connection
    task: Task | None = None
    left: list[str] = field(default_factory=list)

    def give(self, task: Task) -> None:
        """Send it a task."""
        self.task, self.left = task, list(task.models)
        with suppress(OSError):  # it has died, as its pipe will tell
            self.pipe.send(task)

    def receive(self) -> Outcome:
        """Its next outcome; raises EOFError or OSError where it has died."""
        outcome = self.pipe.recv()
        self.left.remove(outcome.model)
        self.task = self.task if self.left else None
        return outcome

    def end(self) -> int:
        """End it, if it has not died; its exit code."""
        self.pipe.close()
        self.process.kill()
        self.process.join()
        return self.process.exitcode or 0


def default_workers() -> int:
    """How many processes the cores and the memory of this machine allow."""
    return int(max(1, min(_cores(), psutil.virtual_memory().available // MEMORY)))


def run_in_processes(tasks: list[Task], workers: int) -> Iterator[Outcome]:
    """Yield the outcomes of tasks, as they come from up to `workers` processes.

    A fit of which a process dies is tried again in a new one, and then counts as failed. The
    processes end with the generator.
    """
    workers = min(workers, len(tasks))
    waiting, deaths = deque(tasks), Counter[tuple[str, str]]()
    crew: list[Worker] = []
    try:
        while waiting or any(worker.task for worker in crew):
            idle = [worker for worker in crew if not worker.task]
            while waiting and (idle or len(crew) < workers):
                if not idle:
                    idle.append(_start(threads=max(1, _cores() // workers)))
                    crew.append(idle[0])
                idle.pop().give(waiting.popleft())
            busy: dict[Any, Worker] = {worker.pipe: worker for worker in crew if worker.task}
            for pipe in wait(list(busy), timeout=1):  # Ctrl-C in another thread does not end it
                worker = busy[pipe]
                try:
                    outcome = worker.receive()
                except (EOFError, OSError):
                    crew.remove(worker)
                    yield from _bury(worker, waiting, deaths)
                else:
                    yield outcome
    finally:
        for worker in crew:
            worker.end()


def _bury(worker, waiting, deaths):
    """Put what a dead worker left back among the `waiting` tasks; yield the outcome of the fit it
    died of, if that was not the first of its `deaths`."""
    worker.process.join(timeout=5)  # its pipe ends before it does
    task, label, code = worker.task, worker.left[0], worker.end()
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


def _start(threads):
    """A `Worker` with a new process, whose kernels run in so many `threads`."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, threads), daemon=True)
    with hold_signals(), _surroundings():  # half a start leaves a process that finds no task
        process.start()
    theirs.close()
    return Worker(process, ours)


@contextmanager
def _surroundings():
    """Within the block, processes start with one thread for NumPy, deaf to Ctrl-C, and without the
    main module: a script that sweeps would sweep again as its processes import it."""
    main, given = sys.modules["__main__"], os.environ.get(THREADS)
    masked = None
    if hasattr(signal, "pthread_sigmask"):
        resource_tracker.ensure_running()  # which would unmask Ctrl-C when it starts
        masked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    sys.modules["__main__"] = ModuleType("__main__")
    os.environ.setdefault(THREADS, "1")
    try:
        yield
    finally:
        sys.modules["__main__"] = main
        if given is None:
            del os.environ[THREADS]
        if masked is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, masked)


def _work(pipe, threads):
    """What a process does: tasks, one after the other, until the pipe is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    use_threads(threads)
    with suppress(EOFError, OSError):
        while True:
            for outcome in fit_models(pipe.recv()):
                pipe.send(outcome)


def _cores():
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
