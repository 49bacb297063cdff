"""The register of all checks by kind of plugin, and helpers for their results and errors."""

import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brdfkit.core.discovery.plugin_files import KINDS


def larger_or_nan(a: float, b: float) -> float:
    """Return the larger of two numbers, or NaN if one is NaN, so that a NaN fails the check."""
    return float(np.maximum(a, b))


# Word in an error message of Dr.Jit → hint for the author of the plugin
HINTS = {
    "'bool'": "write dr.select in place of `if` on values",
    "'ndarray'": "write functions of dr in place of NumPy's",
}


def describe_error(error: BaseException, path: Path) -> str:
    """Describe an error that a plugin raised: the file at `path`, the line, and the reason."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [f.lineno for f in frames if Path(f.filename) == path]
    place = f"{path.name}, line {lines[-1]}" if lines else path.name
    # Mitsuba puts a plugin's traceback into the message, and its last line is the reason
    words = [line.strip() for line in str(error).splitlines() if line.strip()]
    reason = words[-1].rstrip(".") if words else type(error).__name__
    reason = reason.removeprefix("BrdfkitError: ")
    hint = "".join(f"{hint}: " for word, hint in HINTS.items() if word in reason)
    return f"{place}: {hint}{reason}"


Check = Callable[..., tuple[bool, str]]  # takes the subject, returns (passed, figure)
checks: dict[str, dict[str, Check]] = {kind: {} for kind in KINDS}


@dataclass(frozen=True)
class Finding:
    """The result of one check: its name, whether it passed, and the measured figure as a text."""

    check: str
    passed: bool
    figure: str


def check_of(*kinds: str) -> Callable[[Check], Check]:
    """Return a decorator that registers a function as a check of these kinds of plugins.

    The function takes the subject of the check and returns (passed, figure). The name of the check
    is that of the function, without "check_" and with spaces for underscores.
    """

    def register(function: Check) -> Check:
        for kind in kinds:
            checks[kind][function.__name__.removeprefix("check_").replace("_", " ")] = function
        return function

    return register
