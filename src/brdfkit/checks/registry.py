"""The registry of the checks, by kind of plugin, and `Finding`, the result of one check."""

from collections.abc import Callable
from dataclasses import dataclass

from brdfkit.core.discovery.plugin_files import KINDS

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
