"""The checks there are, by the kind of plugin that they are for; and what one finds."""

from collections.abc import Callable
from dataclasses import dataclass

from brdfkit.plugins.discovery import KINDS

checks: dict[str, dict[str, Callable]] = {kind: {} for kind in KINDS}


@dataclass(frozen=True)
class Finding:
    """What one check found: whether it passed, and the figure by which."""

    check: str
    passed: bool
    figure: str


def checked(*kinds):
    """Make a function (subject) → (passed, figure) a check of these kinds, with its own name."""

    def register(function):
        for kind in kinds:
            checks[kind][function.__name__.replace("_", " ")] = function
        return function

    return register
