"""`Upload`: the files that the page sends, in pieces, in a folder that is deleted after reading.

Of the names that the page sends only the last part is used.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import psutil

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_printable
from brdfkit.viewing.temporary_folders import explain_failures, make_folder

LARGEST_UPLOAD = 4 << 30  # bytes of all files of one drop
LARGEST_FILES = 2000  # of one drop, as slices of DICOM
LONGEST_NAME = 200  # bytes, of the 255 that file systems allow


class Upload:
    """The files of one drop, until they are read.

    `files`: their paths, in the order of their arrival. `raw`: the file of voxels whose header the
    user is asked for.
    """

    def __init__(self) -> None:
        self.folder: TemporaryDirectory[str] | None = None
        self.clear()

    def clear(self) -> None:
        """Delete what has arrived."""
        if self.folder is not None:
            self.folder.cleanup()
        self.folder = None
        self.raw: Path | None = None
        self.files: list[Path] = []
        self.declared, self.end = 0, 0  # bytes: of all files, and those of the last one so far

    def add(self, message: dict[str, Any], data: bytes) -> bool:
        """Write a piece of a file; return whether it was the last piece of the last file."""
        try:
            with explain_failures():
                return self._add(message, data)
        except BrdfkitError:
            self.clear()
            raise

    def _add(self, message: dict[str, Any], data: bytes) -> bool:
        size, offset = (to_whole_number(n, message.get(n), 0) for n in ("size", "offset"))
        count = to_whole_number("number of files", message.get("count"), 1, LARGEST_FILES)
        index = to_whole_number("index", message.get("index"), 0, count - 1)
        if index == offset == 0:
            self.clear()
            self.folder = make_folder()
        if offset == 0 and index == len(self.files):
            self._begin_file(message, size)
        fits = offset == self.end and offset + len(data) <= size and (data or not size)
        if index != len(self.files) - 1 or not fits:
            raise BrdfkitError("The file arrived in the wrong order; drop it again.")
        with self.files[-1].open("ab") as stream:
            stream.write(data)
        self.end += len(data)
        return self.end == size and index + 1 == count

    def _begin_file(self, message: dict[str, Any], size: int) -> None:
        """Begin a file of a `size` [bytes], unless there is no room for it."""
        if self.folder is None:
            raise BrdfkitError("The first file did not arrive; drop all of them again.")
        folder, name = Path(self.folder.name), _to_safe_name(message.get("name"))
        room = min(LARGEST_UPLOAD, shutil.disk_usage(folder).free // 2)
        self.declared += size
        if self.declared > min(room, psutil.virtual_memory().available):
            gigabytes = f"{min(self.declared, 1 << 60) / 1e9:.2g} GB"
            raise BrdfkitError(
                f"{name}: {gigabytes} are too many to send; start brdfkit view with the file."
            )
        path = folder / name
        if path.exists():  # from another folder of the drop
            path = folder / f"{len(self.files)}_{name}"
        path.touch(exist_ok=False)
        self.files.append(path)
        self.end = 0


def _to_safe_name(given: Any) -> str:
    """Return the last part of a file's name, fit for any folder, with its suffix."""
    name = Path(to_printable(given).replace("\\", "/")).name
    short = name.encode()[-LONGEST_NAME:].decode(errors="ignore")
    return short if short not in ("", "..") else "file"
