"""Makes the temporary folders of views, as for the files that the page sends.

A folder is deleted even if the program ends at once, while a file in it is being read.
"""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from tempfile import TemporaryDirectory
from weakref import WeakSet

from brdfkit.core.errors import BrdfkitError

_folders: WeakSet[TemporaryDirectory[str]] = WeakSet()
_lock = threading.Lock()  # no set may grow while it is listed


def make_folder() -> TemporaryDirectory[str]:
    """Return a new folder; raise `BrdfkitError` where none can be made."""
    with explain_failures():
        folder = TemporaryDirectory(prefix="brdfkit-view-")
    with _lock:
        _folders.add(folder)
    return folder


def delete_folders() -> None:
    """Delete the folders of all views, whatever reads them; the program is about to end."""
    with _lock:
        for folder in _folders:
            shutil.rmtree(folder.name, ignore_errors=True)


@contextmanager
def explain_failures() -> Iterator[None]:
    """Turn an `OSError` of the block, which writes temporary files, into a `BrdfkitError`."""
    try:
        yield
    except OSError as error:
        raise BrdfkitError(
            f"The file cannot be kept ({error.strerror or error}); make room, or set TMPDIR to "
            "another folder."
        ) from error
