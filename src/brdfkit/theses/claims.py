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
HOLDS_WHERE = "holds where"  # a verdict begins with it that names the settings in which it holds
VERDICTS = CONFIRMED, HOLDS_WHERE, REFUTED, UNSTATED, NOT_RUN


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
        "confirmed", "holds where " and some of the settings that were tried, "not confirmed", "not
        stated" (the thesis gives no figure to compare with) or "not run" (the data for it are
        missing).
    why : str
        Why the figures differ, or how they were compared.
    arithmetic : bool, default False
        Whether this checks a formula by values that were computed apart, or adds printed figures
        up: that tests the code, not what the thesis found, and is counted apart.
    """

    says: str
    where: str
    printed: str
    ours: str
    verdict: str
    why: str = ""
    arithmetic: bool = False

    def __post_init__(self) -> None:
        if self.kind not in VERDICTS:
            raise ValueError(f"{self.verdict!r} is no verdict; there are {', '.join(VERDICTS)}")

    @property
    def kind(self) -> str:
        """The verdict, or "holds where" without the settings."""
        return HOLDS_WHERE if self.verdict.startswith(f"{HOLDS_WHERE} ") else self.verdict


def to_verdict(holds: bool) -> str:
    """Return the verdict on a claim: confirmed if it `holds`, else not confirmed."""
    return CONFIRMED if holds else REFUTED


def count_verdicts(claims: Iterable[Claim]) -> str:
    """Count the claims with each verdict, in words, without verdicts that no claim has.

    >>> count_verdicts([Claim("", "", "", "", "confirmed")])
    '1 confirmed'
    """
    kinds = [claim.kind for claim in claims]
    words = {HOLDS_WHERE: "for some settings"}
    return ", ".join(f"{kinds.count(v)} {words.get(v, v)}" for v in VERDICTS if v in kinds)


def describe_counts(claims: Iterable[Claim]) -> str:
    """Count claims with their verdicts, and checks of arithmetic apart from them, in words.

    >>> sums = Claim("", "", "", "", "confirmed", arithmetic=True)
    >>> describe_counts([Claim("", "", "", "", "not stated"), sums])
    '1 claims: 1 not stated; and 1 checks of arithmetic: 1 confirmed'
    """
    claims = list(claims)
    counted = [claim for claim in claims if not claim.arithmetic]
    checks = [claim for claim in claims if claim.arithmetic]
    words = f"{len(counted)} claims: {count_verdicts(counted)}"
    if not checks:
        return words
    return f"{words}; and {len(checks)} checks of arithmetic: {count_verdicts(checks)}"
