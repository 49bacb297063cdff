"""Starts processes that run cases in turns, and counts the CPU seconds of commands."""

import json
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager, suppress
from pathlib import Path

BENCHMARKS = Path(__file__).resolve().parents[1]
# Of several calls the least time counts. Calls end after this many, or when they took so long [s]
TURNS, PATIENCE = 6, 4.0
LONG = 60.0  # seconds of a first call that counts, although it compiles


class TimingProcess:
    """A process that runs cases with the sources of one version of brdfkit.

    `source`: the folder `src` of the version; `environment`: further variables.
    """

    def __init__(self, source, environment):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "performance.timing_process"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env=make_environment(source) | environment,
        )

    def ask(self, case):
        """Run a case, and return what it tells: its "seconds", or an "error"."""
        try:
            self.process.stdin.write(case + "\n")
            self.process.stdin.flush()
            return json.loads(self.process.stdout.readline())
        except (BrokenPipeError, json.JSONDecodeError):
            return {"error": "the process ended"}

    def close(self):
        """Let the process end."""
        with suppress(BrokenPipeError):
            self.process.stdin.close()
        self.process.wait()


def make_environment(source):
    """Return the variables of a process that imports brdfkit from the folder `source`."""
    path = os.pathsep.join([str(source), str(BENCHMARKS)])
    return os.environ | {"PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"}


@contextmanager
def start_processes(sources, **environment):
    """Start a `TimingProcess` for each of `sources`, by their labels, and close them at the end."""
    started = {label: TimingProcess(source, environment) for label, source in sources.items()}
    try:
        yield started
    finally:
        for process in started.values():
            process.close()


def race(entries):
    """Run cases in turns, and return what each told when it was fastest.

    `entries`: by label, a `TimingProcess` and the name of a case. The first call of each compiles,
    and counts only if it was long; its seconds beyond the least are "compiling".
    """
    first, best, spent = {}, {}, dict.fromkeys(entries, 0.0)
    for turn in range(TURNS):
        for label, (process, case) in entries.items():
            done = label in best and spent[label] > PATIENCE
            if done or "error" in best.get(label, {}):
                continue
            told = process.ask(case)
            spent[label] += told.get("seconds", 0.0)
            if not turn:
                first[label] = told
            least = best.get(label, {}).get("seconds", float("inf"))
            if "error" in told or ((turn or told["seconds"] > LONG) and told["seconds"] < least):
                best[label] = told
    for label, told in best.items():
        if "error" not in told:
            told["prepared"] = first[label]["prepared"]
            told["compiling"] = first[label]["seconds"] - told["seconds"]
    return best


def count_cpu_seconds(commands, times):
    """Return the least CPU seconds of processes, by label; they take turns.

    `commands`: by label, the folder of brdfkit's sources and the arguments of Python. A process
    that fails has an "error" instead.
    """
    best = {}
    for _ in range(times):
        for label, (source, arguments) in commands.items():
            own = subprocess.Popen(
                [sys.executable, *arguments],
                env=make_environment(source),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            _, status, used = os.wait4(own.pid, 0)
            own.returncode = os.waitstatus_to_exitcode(status)
            seconds = used.ru_utime + used.ru_stime
            if own.returncode:
                best[label] = {"error": f"exit status {own.returncode}"}
            elif "error" not in best.get(label, {}):
                best[label] = {"seconds": min(seconds, best.get(label, {}).get("seconds", seconds))}
    return best


def describe_machine():
    """Return the names and numbers that times depend on."""
    import platform

    import psutil

    return {
        "cpu": read_cpu_name() or platform.machine(),
        "cores": os.cpu_count(),
        "memory": round(psutil.virtual_memory().total / 2**30),
    }


def read_cpu_name():
    """Return the name of the processor as Linux tells it, or nothing."""
    file = Path("/proc/cpuinfo")
    lines = file.read_text().splitlines() if file.exists() else []
    return next((line.partition(":")[2].strip() for line in lines if "model name" in line), "")


def read_commit(folder):
    """Return the short name of a folder's commit, or nothing."""
    git = shutil.which("git")
    if not git:
        return ""
    command = [git, "-C", str(folder), "rev-parse", "--short=8", "HEAD"]
    return subprocess.run(command, capture_output=True, text=True).stdout.strip()
