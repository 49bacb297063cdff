# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Dr.Jit loads
"""Runs cases in this process: a name on each line of the input, figures as JSON in the output.

    PYTHONPATH=src:benchmarks python -m performance.timing_process

A case is prepared when it is first named. A name is GROUP: CASE, and the cases of a group are
forgotten when another group is named.
"""

import json
import os
import re
import sys
import time

import brdfkit  # noqa: F401

from performance.memory import read_resident_memory

PATH = re.compile(r"/\S+")  # of this machine, which no page should show


def find_cases():
    """Return the functions that prepare cases, by name."""
    from performance import fits, growth, pictures, traffic

    return fits.CASES | growth.CASES | pictures.CASES | traffic.CASES


def run_case(prepared, cases, name):
    """Run a case, and return its seconds, those of its preparation, and what it tells."""
    began = time.perf_counter()
    if name not in prepared:
        group = name.partition(":")[0]
        for other in [other for other in prepared if other.partition(":")[0] != group]:
            del prepared[other]
        prepared[name] = cases[name]()
    ready = time.perf_counter()
    told = prepared[name]()
    answer = {"seconds": time.perf_counter() - ready, "prepared": ready - began}
    answer["MB"] = read_resident_memory(peak=True) / 1e6
    return answer | (told if isinstance(told, dict) else {})


def main():
    """Answer until the input ends."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # what libraries print is not part of an answer
    cases, prepared = find_cases(), {}
    for line in sys.stdin:
        try:
            answer = run_case(prepared, cases, line.strip())
        except Exception as error:
            told = f"{type(error).__name__}: {error}".splitlines()[0]
            answer = {"error": PATH.sub("…", told)}
        print(json.dumps(answer), file=answers)


if __name__ == "__main__":
    main()
