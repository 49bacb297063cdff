"""Finds the works that a text cites; `references.toml` describes each work once.

A text cites a work by its key in brackets:

[Ward 1992]    [Kurt 2007, eqs. 3.6, 3.7]    [Cook & Torrance 1982]
"""

import re
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from unicodedata import normalize

# [Key 1992] or [Key 1992, place in the work]; a line may break within it
CITATION = re.compile(r"\[([A-ZÀ-Ž][^\[\]]*?\s\d{4}[a-z]?)(?:,\s[^\[\]]*)?\]")


@dataclass(frozen=True)
class Reference:
    """A cited work; `where` is the journal, conference or university, `link` an address."""

    key: str
    authors: str
    title: str
    where: str
    link: str = ""

    def __str__(self) -> str:
        year = re.findall(r"\d{4}", self.key)[0]
        link = f". {self.link}" if self.link else ""
        return f"[{self.key}] {self.authors}, “{self.title}”, {self.where}, {year}{link}"


@cache
def read_references() -> dict[str, Reference]:
    """Return all works by key, in alphabetical order."""
    entries = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    keys = sorted(entries, key=lambda key: normalize("NFKD", key))  # sorts Ö beside O
    return {key: Reference(key, **entries[key]) for key in keys}


def find_citations(text: str) -> list[str]:
    """Return the keys of the works that a text cites, each once, in the order of the text.

    >>> find_citations("Lambert's law [Lambert 1760]; [Kurt 2007, eq. 3.1].")
    ['Lambert 1760', 'Kurt 2007']
    """
    return list(dict.fromkeys(" ".join(key.split()) for key in CITATION.findall(text)))


def find_cited_works(text: str) -> list[Reference]:
    """Return the works that a text cites; keys that are not in `references.toml` are left out."""
    return [read_references()[key] for key in find_citations(text) if key in read_references()]
