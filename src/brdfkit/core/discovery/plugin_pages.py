"""The page of a plugin: the docstring of its file.

The first line is ``Title: one sentence.``; the formula, where there is one, and prose follow.
"""

import inspect
import re
import sys
from dataclasses import dataclass

from brdfkit.core.discovery import plugin_files
from brdfkit.core.references import find_cited_works

SHOWS = re.compile(r"\b(?:It s|S)(hows .*?\.)(?=\s|$)")


@dataclass(frozen=True)
class Page:
    """A page: its `title`, one `sentence`, and the `lines` that follow the first."""

    title: str
    sentence: str
    lines: tuple[str, ...]

    def __str__(self):
        return "\n".join([f"{self.title}: {self.sentence}", *self.lines])

    @property
    def shows(self):
        """Which materials a model shows, and what it does not: the sentence that begins so."""
        found = SHOWS.search(" ".join(self.lines))
        return f"S{found.group(1)}" if found else ""

    @property
    def references(self):
        """The cited works, as `Reference`s."""
        return find_cited_works(str(self))


def read_page(source):
    """The `Page` of a plugin, given as its file or its class.

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
