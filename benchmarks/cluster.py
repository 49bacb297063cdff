"""Measures what tasks cost on a Dask cluster: bytes, messages, the scheduler's time, and scaling.

    python benchmarks/cluster.py     # 5 minutes; prints three tables in Markdown

`measure` counts what the scheduler receives and sends for each task of `sweep`, `compare`, `rank`
and `render` with one worker, and derives what 100 materials × 15 models need on 100 workers.
`measure_scheduler` gives the processor time of the scheduler for each task, with 100 workers that
have nothing to compute. `measure_scaling` compares one worker with two. Seconds are of this
machine.
"""

import asyncio
import multiprocessing
import operator
import os
import sys
import time
from contextlib import AsyncExitStack, ExitStack, contextmanager
from functools import partial
from tempfile import TemporaryDirectory

import psutil

import brdfkit as bk
from brdfkit.core import cluster

MODELS = ["lambert", "koenderink", "ggx", "ward"]
FILES = ["plaster", "satin_plastic", "red_plastic"]
# What users do, by name; a task is what it is for 100 materials × 15 models: as `sweep` cuts them
# on 100 workers, about 4 models; one model; or 16 samples for each pixel
JOBS = {
    "`sweep`, 4 models": lambda client: bk.sweep(FILES, MODELS, client=client),
    "`compare`, 1 model": lambda client: bk.compare("car_paint", MODELS, client=client),
    "`rank`, 1 model": lambda client: bk.rank("plaster", MODELS, client=client),
    "`render`, 512²×16 samples": lambda client: bk.render("plaster", spp=64, client=client),
}
WORKERS = 100
# Number of tasks with which the scheduler is timed, by the bytes of their results; the last is a
# picture of 512² pixels
RESULTS = {10: 1000, 10_000: 1000, 3_145_728: 200}
TURNS = 2  # number of measurements with one worker and with two, in turns


def count_traffic():
    """Count the bytes and messages of all TCP connections of this process in a dictionary."""
    from distributed.comm import tcp

    counts = dict.fromkeys(["bytes in", "messages in", "bytes out", "messages out"], 0)
    read, write, parse = tcp.TCP.read, tcp.TCP.write, tcp.from_frames

    def count_messages(message):
        """Return the number of messages that are sent as one."""
        return len(message) if isinstance(message, list | tuple) else 1

    async def counted_parse(frames, **options):
        counts["bytes in"] += sum(memoryview(frame).nbytes for frame in frames)
        return await parse(frames, **options)

    async def counted_read(self, *arguments, **options):
        message = await read(self, *arguments, **options)
        counts["messages in"] += count_messages(message)
        return message

    async def counted_write(self, message, *arguments, **options):
        counts["messages out"] += count_messages(message)
        sent = await write(self, message, *arguments, **options)
        counts["bytes out"] += sent
        return sent

    tcp.TCP.read, tcp.TCP.write, tcp.from_frames = counted_read, counted_write, counted_parse
    return counts


async def serve_scheduler(pipe):
    """Run a scheduler, and send its address through the pipe."""
    from distributed import Scheduler

    counts = count_traffic()
    async with Scheduler(host="127.0.0.1", port=0, dashboard=False) as scheduler:
        scheduler.traffic = counts
        pipe.send(scheduler.address)
        await scheduler.finished()


async def serve_workers(pipe, address, count):
    """Run workers with one thread each, and send their number through the pipe."""
    from distributed import Worker

    if count > 1:  # they have nothing to compute, and would disturb each other
        cluster.set_thread_count = lambda count: None
    with TemporaryDirectory() as folder:
        async with AsyncExitStack() as stack:
            options = {"nthreads": 1, "local_directory": folder, "dashboard": False}
            for _ in range(count):
                await stack.enter_async_context(Worker(address, **options))
            pipe.send(count)
            await asyncio.Event().wait()


def run_server(serve, *arguments):
    """Run an asynchronous function in a process."""
    asyncio.run(serve(*arguments))


@contextmanager
def start_process(serve, *arguments):
    """Run a server in a process of its own; yield the process and what it sends first."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=run_server, args=(serve, theirs, *arguments), daemon=True)
    process.start()
    try:
        yield psutil.Process(process.pid), ours.recv()
    finally:
        process.kill()
        process.join()


@contextmanager
def start_cluster(*workers):
    """Start a scheduler and a process for each number of `workers`; yield a client and processes.

    The first process is the scheduler's.
    """
    from distributed import Client

    os.environ.setdefault("DASK_LOGGING__DISTRIBUTED", "error")  # for the processes
    with ExitStack() as stack:
        scheduler, address = stack.enter_context(start_process(serve_scheduler))
        servers = [stack.enter_context(start_process(serve_workers, address, n)) for n in workers]
        client = stack.enter_context(Client(address))
        yield client, [scheduler, *(process for process, _ in servers)]


def count_seconds(process):
    """Return the processor seconds that a process has used."""
    return sum(process.cpu_times()[:2])


def read_traffic(client):
    """Return what the scheduler of a client has counted."""
    return client.run_on_scheduler(lambda dask_scheduler: dict(dask_scheduler.traffic))


@contextmanager
def record_parcels():
    """Record the lengths of all parcels in a list: what tasks share, then each task."""
    lengths, pack = [], cluster.Parcel.pack

    def recorded_pack(*arguments):
        parcel = pack(*arguments)
        lengths.append(len(parcel.data))
        return parcel

    cluster.Parcel.pack = recorded_pack
    try:
        yield lengths
    finally:
        cluster.Parcel.pack = pack


def measure_job(call, client, worker):
    """Return of one call: the lengths of parcels, what the scheduler counted, the worker's seconds.

    The traffic of an idle cluster, such as heartbeats, is subtracted.
    """

    def measure_call(function):
        """Return the traffic, the worker's seconds and the wall-clock seconds of a call."""
        before, began, cpu = read_traffic(client), time.perf_counter(), count_seconds(worker)
        function()
        seconds, used = time.perf_counter() - began, count_seconds(worker) - cpu
        after = read_traffic(client)
        return [*(after[name] - before[name] for name in after), used], seconds

    call(client)  # imports and compiles
    idle, idle_seconds = measure_call(lambda: time.sleep(4))
    with record_parcels() as lengths:
        busy, seconds = measure_call(lambda: call(client))
    return lengths, [b - i * seconds / idle_seconds for b, i in zip(busy, idle, strict=True)]


def measure():
    """Return a table: its heads, and a row for each job with its costs for each task.

    The bytes that pass the scheduler leave out what all tasks share, which it sends only once. The
    last two columns are what 100 workers bring about if they always have tasks.
    """
    head = ["a task of", "shared [kB]", "task [kB]", "received [kB]", "sent [kB]", "messages"]
    rows = [[*head, "worker [s]", "tasks/s", "received and sent [MB/s]"]]
    with start_cluster(1) as (client, (_, worker)):
        for name, call in JOBS.items():
            (shared, *own), costs = measure_job(call, client, worker)
            once, count = shared if shared > cluster.SMALL else 0, len(own)
            came, read, went, written, seconds = (cost / count for cost in costs)
            sizes = shared, sum(own) / count, came - once / count, went - once / count
            rate = WORKERS / seconds
            rest = f"{read + written:.0f}", f"{seconds:.2f}", f"{rate:.0f}"
            flow = f"{(sizes[2] + sizes[3]) * rate / 1e6:.1f}"
            rows.append([name, *(f"{size / 1e3:.1f}" for size in sizes), *rest, flow])
    return rows


def measure_scheduler():
    """Return a table: its heads, and the costs of tasks that only return bytes, to 100 workers."""
    rows = [
        ["result of a task", "scheduler [ms]", "client [ms]", "tasks/s that fill the scheduler"]
    ]
    with start_cluster(WORKERS) as (client, (scheduler, _)):
        for length, count in RESULTS.items():
            tasks = [length] * count
            run = partial(cluster.run_tasks, operator.mul, client=client, shared=b"x")
            list(run(tasks[:WORKERS]))
            before = [count_seconds(one) for one in (scheduler, psutil.Process())]
            list(run(tasks))
            after = [count_seconds(one) for one in (scheduler, psutil.Process())]
            costs = [1e3 * (b - a) / count for a, b in zip(before, after, strict=True)]
            each = f"{costs[0]:.2f}", f"{costs[1]:.2f}", f"{1e3 / costs[0]:.0f}"
            rows.append([f"{length:,} bytes", *each])
    return rows


def measure_scaling():
    """Return a table: its heads, and the least seconds of each job with one worker and with two."""
    rows = [["job", "1 worker [s]", "2 workers [s]", "ratio"]]
    with start_cluster(1) as (one, _), start_cluster(1, 1) as (two, _):
        for name, call in JOBS.items():
            least = [float("inf")] * 2
            for turn in range(TURNS + 1):
                for place, client in enumerate((one, two)):
                    began = time.perf_counter()
                    call(client)
                    if turn:  # the first call imports and compiles
                        least[place] = min(least[place], time.perf_counter() - began)
            rows.append([name, *(f"{s:.1f}" for s in least), f"{least[0] / least[1]:.2f}"])
    return rows


def main():
    """Print the three tables."""
    for table in (measure(), measure_scheduler(), measure_scaling()):
        lines = [table[0], ["---"] * len(table[0]), *table[1:]]
        print(*("| " + " | ".join(line) + " |" for line in lines), "", sep="\n", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
