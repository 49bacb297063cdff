"""The registry of the checks, by kind of plugin, and `Finding`, the result of one check."""

import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brdfkit.core.discovery.plugin_files import KINDS


def larger(a, b):
    """The larger of two figures, NaN if one is NaN: what is not a number must not pass as small."""
    return float(np.maximum(a, b))


# Words in an error of Dr.Jit's → what the plugin's author should write
HINTS = {
    "'bool'": "write dr.select in place of `if` on values",
    "'ndarray'": "write functions of dr in place of NumPy's",
}


def describe(error, path):
    """`error` in words: the plugin's file (`Path`) and the line that raised it, and the reason."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [f.lineno for f in frames if Path(f.filename) == path]
    place = f"{path.name}, line {lines[-1]}" if lines else path.name
    # Mitsuba puts a plugin's traceback into the message
    words = [line.strip() for line in str(error).splitlines() if line.strip()]
    reason = words[-1].rstrip(".") if words else type(error).__name__
    reason = reason.removeprefix("BrdfkitError: ")
    hint = "".join(f"{hint}: " for word, hint in HINTS.items() if word in reason)
    return f"{place}: {hint}{reason}"


checks: dict[str, dict[str, Callable]] = {kind: {} for kind in KINDS}


@dataclass(frozen=True)
class Finding:
    """The result of one check: its name, whether it passed, and the measured `figure` in words."""

    check: str
    passed: bool
    figure: str


def check_of(*kinds):
    """Register a function (subject) → (passed, figure) as a check of these kinds of plugins.

    The check has the function's name, with spaces for underscores.
    """

    def register(function):
        for kind in kinds:
            checks[kind][function.__name__.replace("_", " ")] = function
        return function

    return register
