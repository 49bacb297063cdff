"""How long a call takes."""

import time


def cpu_seconds(function, *arguments):
    """Seconds of CPU of a call of `function`."""
    start = time.process_time()
    function(*arguments)
    return time.process_time() - start


def least_seconds(function, *arguments, times=3):
    """The least seconds of CPU of a few calls."""
    return min(cpu_seconds(function, *arguments) for _ in range(times))
