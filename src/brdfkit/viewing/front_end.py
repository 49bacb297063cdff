"""Reads the files of the page: its parts in JavaScript are joined to one ES module."""

from functools import cache
from pathlib import Path

FOLDER = Path(__file__).with_name("page")
PARTS = (  # in the order in which the module contains them
    "dom.js",
    "session.js",
    "controls.js",
    "history.js",
    "picture.js",
    "overlay.js",
    "wipe.js",
    "camera.js",
    "transfer_points.js",
    "transfer_bumps.js",
    "transfer_plot.js",
    "transfer_editor.js",
    "slices.js",
    "clip_box.js",
    "dialogs.js",
    "files.js",
    "toolbar.js",
    "status.js",
    "viewer.js",
)


@cache
def read_module() -> str:
    """Return the ES module of the page and of the widget."""
    return "\n".join(read_page_file(part) for part in PARTS)


def read_page_file(name: str) -> str:
    """Return the text of a file of the page."""
    return (FOLDER / name).read_text(encoding="utf-8")
