"""Reads the memory that this process holds and has held."""

import re
from pathlib import Path

import psutil

STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")


def reset_peak():
    """Let the largest memory begin anew at the present one; on Linux alone."""
    if CLEAR.exists():
        CLEAR.write_text("5", encoding="ascii")


def read_resident_memory(peak=False):
    """Return the resident memory [bytes], now or, on Linux, the largest since `reset_peak`."""
    if peak and STATUS.exists():
        return 1024 * int(re.search(r"VmHWM:\s+(\d+)", STATUS.read_text())[1])
    return psutil.Process().memory_info().rss
