"""Runs the tasks of a sweep in processes of this machine, so that a crash costs only one fit.

Processes are spawned, not forked, because the threads of Dr.Jit do not survive a fork. Each process
receives tasks through a pipe, and sends every fit back as soon as it is finished.
`ProcessPoolExecutor` is no alternative: the death of one process ends its whole pool, and it does
not report which fit the process was working on.
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

from brdfkit.core.interrupts import delay_signals
from brdfkit.core.jit.threads import set_thread_count
from brdfkit.fitting.sweeping.tasks import Outcome, Task, fit_models, make_failed_outcome

MEMORY = 10**9  # memory of a process [bytes]; fitting a MERL table takes 0.55 GB
LIVES = 2  # a fit counts as failed when it has killed this number of processes
THREADS = "OMP_NUM_THREADS"  # environment variable that NumPy reads when it is imported


@dataclass
class Worker:
    """A process that carries out tasks, and the pipe to it.

    `task` is the task that the process works on, None if it is idle; `left` contains the labels of
    the models whose outcomes it has not sent yet.
    """

    process: BaseProcess
    pipe: Connection
    task: Task | None = None
    left: list[str] = field(default_factory=list)

    def send_task(self, task: Task) -> None:
        """Send a task to the process."""
        self.task, self.left = task, list(task.models)
        with suppress(OSError):  # the process has died, which reading the pipe will report
            self.pipe.send(task)

    def receive_outcome(self) -> Outcome:
        """Receive the next outcome; raises EOFError or OSError if the process has died."""
        outcome = self.pipe.recv()
        self.left.remove(outcome.model)
        self.task = self.task if self.left else None
        return outcome

    def kill_process(self) -> int:
        """Kill the process, if it is still alive, and return its exit code."""
        self.pipe.close()
        self.process.kill()
        self.process.join()
        return self.process.exitcode or 0


def choose_worker_count() -> int:
    """Return the number of processes for which the cores and the memory of this machine suffice."""
    return int(max(1, min(_count_cores(), psutil.virtual_memory().available // MEMORY)))


def run_in_processes(tasks: list[Task], workers: int) -> Iterator[Outcome]:
    """Yield the outcomes of tasks in the order in which up to `workers` processes finish them.

    If a process dies during a fit, a new process tries the fit once more; then the fit counts as
    failed. All processes are killed when the generator ends.
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
                idle.pop().send_task(waiting.popleft())
            busy: dict[Any, Worker] = {worker.pipe: worker for worker in crew if worker.task}
            # The time limit lets Ctrl-C through, which does not interrupt the waiting itself
            for pipe in wait(list(busy), timeout=1):
                worker = busy[pipe]
                try:
                    outcome = worker.receive_outcome()
                except (EOFError, OSError):
                    crew.remove(worker)
                    yield from _replace_dead_worker(worker, waiting, deaths)
                else:
                    yield outcome
    finally:
        for worker in crew:
            worker.kill_process()


def _replace_dead_worker(
    worker: Worker, waiting: deque[Task], deaths: Counter[tuple[str, str]]
) -> Iterator[Outcome]:
    """Put the unfinished fits of a dead worker back in the queue `waiting`.

    `deaths` counts the dead processes by material and model. A fit that has killed `LIVES`
    processes is not repeated; its failure is yielded.
    """
    worker.process.join(timeout=5)  # its pipe closes before it has an exit code
    task, label, code = worker.task, worker.left[0], worker.kill_process()
    assert task is not None
    deaths[task.material, label] += 1
    if deaths[task.material, label] == LIVES:
        how = signal.Signals(-code).name if code < 0 else f"exit status {code}"
        yield make_failed_outcome(
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
    process = context.Process(target=_carry_out_tasks, args=(theirs, threads), daemon=True)
    # An interrupted start would leave a process that nobody ends
    with delay_signals(), _prepare_for_spawn():
        process.start()
    theirs.close()
    return Worker(process, ours)


@contextmanager
def _prepare_for_spawn() -> Iterator[None]:
    """Give processes that start in this context one NumPy thread, and let them ignore Ctrl-C.

    The main module is hidden from them: if it is a script that calls `sweep`, importing it would
    start the sweep again.
    """
    main, old_threads = sys.modules["__main__"], os.environ.get(THREADS)
    masked = None
    if hasattr(signal, "pthread_sigmask"):
        resource_tracker.ensure_running()  # if it started later, it would unmask Ctrl-C
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


def _carry_out_tasks(pipe: Connection, threads: int) -> None:
    """Carry out tasks from the `pipe` until it is closed; this is what a process runs."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    set_thread_count(threads)
    with suppress(EOFError, OSError):
        while True:
            for outcome in fit_models(pipe.recv()):
                pipe.send(outcome)


def _count_cores() -> int:
    """Return how many processor cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
