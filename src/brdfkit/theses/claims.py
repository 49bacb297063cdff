"""Defines `Claim`: a claim of a thesis, the printed and the reproduced figures, and a verdict."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any


def measure_cpu_seconds(function: Callable[..., Any], *arguments: Any) -> float:
    """Return the CPU seconds that a call of a function takes."""
    start = time.process_time()
    function(*arguments)
    return time.process_time() - start


def measure_least_seconds(function: Callable[..., Any], *arguments: Any, times: int = 3) -> float:
    """Return the CPU seconds of the fastest of a few calls, disturbed least by other processes."""
    return min(measure_cpu_seconds(function, *arguments) for _ in range(times))


CONFIRMED, REFUTED, UNSTATED, NOT_RUN = "confirmed", "not confirmed", "not stated", "not run"
VERDICTS = CONFIRMED, REFUTED, UNSTATED, NOT_RUN


@dataclass(frozen=True)
class Claim:
    """A claim of a thesis, and whether it holds here.

    Attributes
    ----------
    says : str
        The claim as a sentence.
    where : str
        The table, equation or page of the claim.
    printed : str
        The figures printed there.
    ours : str
        The figures that come out here.
    verdict : str
        "confirmed", "not confirmed", "not stated" (the thesis gives no figure to compare with) or
        "not run" (the data for it are missing).
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


def to_verdict(holds: bool) -> str:
    """Return the verdict on a claim: confirmed if it `holds`, else not confirmed."""
    return CONFIRMED if holds else REFUTED


def count_verdicts(claims: Iterable[Claim]) -> str:
    """Count the claims with each verdict, in words, without verdicts that no claim has.

    >>> count_verdicts([Claim("", "", "", "", "confirmed")])
    '1 confirmed'
    """
    verdicts = [c.verdict for c in claims]
    return ", ".join(f"{verdicts.count(v)} {v}" for v in VERDICTS if v in verdicts)
