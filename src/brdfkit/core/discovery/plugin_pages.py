"""Reads a plugin's page of help, which is the docstring of its file.

The first line is ``Title: one sentence.``; then follow the formula, if there is one, and prose.
"""

import inspect
import re
import sys
from dataclasses import dataclass
from pathlib import Path

from brdfkit.core.discovery import plugin_files
from brdfkit.core.references import Reference, find_cited_works

SUITS = re.compile(r"\bIt suits (.*?\.)(?=\s|$)")


@dataclass(frozen=True)
class Page:
    """A plugin's page: `title` and `sentence` are its first line, and `lines` the others."""

    title: str
    sentence: str
    lines: tuple[str, ...]

    def __str__(self) -> str:
        return "\n".join([f"{self.title}: {self.sentence}", *self.lines])

    @property
    def suitable_materials(self) -> str:
        """The sentence on the materials that a BRDF model suits, or "" if its page has none."""
        match = SUITS.search(" ".join(self.lines))
        return f"Suits {match.group(1)}" if match else ""

    @property
    def references(self) -> list[Reference]:
        """The works that the page cites."""
        return find_cited_works(str(self))


def read_page(source: Path | type) -> Page:
    """Read the page of help of a plugin, given as its file or its class.

    A class that no plugin file defines has its own docstring as its page.
    """
    if isinstance(source, type):
        in_file = source.__module__.rpartition(".")[0] in plugin_files.PACKAGES_OF_MODELS
        text = sys.modules[source.__module__].__doc__ if in_file else source.__doc__
        name = source.__name__
    else:
        text, name = plugin_files.import_plugin(source).__doc__, source.stem
    first, *lines = inspect.cleandoc(text or "").splitlines() or [""]
    title, colon, sentence = first.partition(": ")
    if not colon:
        title, sentence = name, first
    return Page(title, sentence, tuple(lines))
