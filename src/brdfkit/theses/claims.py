"""`Claim`: what a thesis says, where, and what comes out when it is run."""

import time
from dataclasses import dataclass


def measure_cpu_seconds(function, *arguments):
    """Seconds of CPU of a call of `function`."""
    start = time.process_time()
    function(*arguments)
    return time.process_time() - start


def measure_least_seconds(function, *arguments, times=3):
    """The least seconds of CPU of a few calls."""
    return min(measure_cpu_seconds(function, *arguments) for _ in range(times))


CONFIRMED, REFUTED, UNSTATED, NOT_RUN = "confirmed", "not confirmed", "not stated", "not run"
VERDICTS = CONFIRMED, REFUTED, UNSTATED, NOT_RUN


@dataclass(frozen=True)
class Claim:
    """One claim of a thesis.

    Attributes
    ----------
    says : str
        What the thesis says.
    where : str
        The table, equation or page that says it.
    printed : str
        The figures printed there.
    ours : str
        The figures that come out here.
    verdict : str
        "confirmed", "not confirmed", "not stated" (the thesis gives no figure to hold ours
        against) or "not run" (what it needs is not at hand).
    why : str
        Why the figures differ, or how they were compared.
    """

    says: str
    where: str
    printed: str
    ours: str
    verdict: str
    why: str = ""

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise ValueError(f"{self.verdict!r} is no verdict; there are {', '.join(VERDICTS)}")


def verdict(holds):
    """The verdict on a claim that `holds` or not."""
    return CONFIRMED if holds else REFUTED


def count_verdicts(claims):
    """How many claims have each verdict, in words, without those that none has.

    >>> count_verdicts([Claim("", "", "", "", "confirmed")])
    '1 confirmed'
    """
    found = [c.verdict for c in claims]
    return ", ".join(f"{found.count(v)} {v}" for v in VERDICTS if v in found)
