"""Reads the files of the page: its parts in JavaScript are joined to one ES module."""

from functools import cache
from pathlib import Path

FOLDER = Path(__file__).with_name("page")


@cache
def read_module() -> str:
    """Return the ES module of the page and of the widget.

    The parts are scripts of functions and constants, so that their order does not matter; page.js
    alone is a module of its own.
    """
    parts = sorted(path.name for path in FOLDER.glob("*.js") if path.name != "page.js")
    return "\n".join(read_page_file(part) for part in parts)


def read_page_file(name: str) -> str:
    """Return the text of a file of the page."""
    return (FOLDER / name).read_text(encoding="utf-8")
