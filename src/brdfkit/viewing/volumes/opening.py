"""Opens the files that the page sends: volumes, environment maps, transfer functions and settings.

The page sends a file in pieces. They are written into a folder of their own, which is deleted as
soon as the file was read; of the names that the page sends only the last part is used.
"""

from __future__ import annotations

import json
import shutil
import tempfile
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil

from brdfkit import volumes
from brdfkit.core.errors import BrdfkitError
from brdfkit.volumes import TransferFunction

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.session import Session

    Application = Any  # `VolumeApplication`, which imports this file

LARGEST_UPLOAD = 4 << 30  # bytes of all files of one drop
LARGEST_FILES = 2000  # of one drop, as slices of DICOM
RAW = ".raw", ".bin", ".dat", ".img", ".vol"  # suffixes of files without a header
DTYPES = "uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"


class Upload:
    """The files of one drop, until all of them have arrived."""

    def __init__(self) -> None:
        self.folder: Path | None = None
        self.received = 0
        self.path: Path | None = None

    def add(self, message: dict[str, Any], data: bytes) -> bool:
        """Write a piece of a file; return whether it was the last piece of the last file."""
        name = Path(str(message.get("name", "file")).replace("\\", "/")).name or "file"
        size, offset = int(message.get("size", 0)), int(message.get("offset", 0))
        index, count = int(message.get("index", 0)), int(message.get("count", 1))
        if index == 0 and offset == 0:
            self.clear()
            self.folder = Path(tempfile.mkdtemp(prefix="brdfkit-view-"))
        if self.folder is None or not 1 <= count <= LARGEST_FILES or offset > size:
            raise BrdfkitError("The file arrived in the wrong order; drop it again.")
        self.received += len(data)
        free = min(LARGEST_UPLOAD, shutil.disk_usage(self.folder).free // 2)
        if max(size, self.received) > free:
            self.clear()
            raise BrdfkitError(
                f"{name}: {size / 1e9:.2g} GB are too many to send; start brdfkit view with it."
            )
        self.path = self.folder / name[:200]
        with self.path.open("r+b" if offset else "wb") as stream:
            stream.seek(offset)
            stream.write(data)
        return offset + len(data) >= size and index + 1 >= count

    def clear(self) -> None:
        """Delete what has arrived."""
        if self.folder is not None:
            shutil.rmtree(self.folder, ignore_errors=True)
        self.folder, self.path, self.received = None, None, 0


def load_upload(
    application: Application, session: Session, message: dict[str, Any], data: bytes
) -> list[Message]:
    """Take a piece of a file, and open the file after its last piece."""
    upload = application.upload
    if message["type"] == "raw":
        return _open_raw(application, session, message)
    if not upload.add(message, data):
        return [({"type": "uploaded"}, [])]
    kind = str(message.get("kind"))
    path = upload.path
    if kind == "volume" and path.suffix.lower() in RAW and not _has_header(path):
        guess = {"size": _guess_cube(path.stat().st_size), "dtype": "uint8", "spacing": [1, 1, 1]}
        question = {"type": "ask_raw", "name": path.name, "bytes": path.stat().st_size}
        return [(question | {"guess": guess, "dtypes": DTYPES}, [])]
    try:
        return _open(application, session, kind, path, int(message.get("count", 1)))
    finally:
        upload.clear()


def _open(
    application: Application, session: Session, kind: str, path: Path, count: int
) -> list[Message]:
    """Open a file of a kind, or the folder of several files."""
    if kind == "volume":
        return _open_volume(application, session, path.parent if count > 1 else path)
    if kind == "environment":
        application.states.add_environment(path)
        session.handle({"type": "set", "changes": {"light.environment": path.name}})
        return [session.describe_view()]
    text = path.read_bytes()
    if kind == "transfer":
        function, name = TransferFunction.load(path), path.name.split(".")[0]
        session.replace_state(application.states.with_function(session.state, function, name))
        return [session.describe_state()]
    try:
        changes = json.loads(text)
    except ValueError as error:
        raise BrdfkitError(
            f"{path.name}: is no JSON ({error}); choose settings of a view."
        ) from None
    return session.handle({"type": "set", "changes": changes, "moving": False})


def _open_volume(
    application: Application, session: Session, path: Path, **settings: Any
) -> list[Message]:
    """Show the volume of a file or folder."""
    notes: list[Message] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        volume = load_within_memory(path, **settings)
    for warning in caught:
        notes.append(({"type": "error", "text": str(warning.message)}, []))
    application.show(volume, path.name)
    session.open(application.first_state())
    return [session.describe_view(), *notes]


def load_within_memory(path: str | Path, **settings: Any) -> Any:
    """Load a volume, averaged to fewer voxels if there is not memory enough for its view.

    A view needs the voxels as 32-bit floats and their gradient magnitudes, in Mitsuba as well.
    Warns if voxels are averaged.
    """
    try:
        volume = volumes.load(path, **settings)
    except BrdfkitError as error:
        factor = _proposed_factor(str(error))
        if factor is None:
            raise
        warnings.warn(
            f"{Path(path).name} is too large for the memory, and {factor}³ voxels become one.",
            stacklevel=2,
        )
        return volumes.load(path, downsample=factor, **settings)
    factor = 1
    while 20 * volume.values.size / factor**3 > psutil.virtual_memory().available:
        factor += 1
    if factor == 1:
        return volume
    warnings.warn(
        f"{volume.name} is too large for the memory, and {factor}³ voxels become one.", stacklevel=2
    )
    return volume.resized(factor)


def _proposed_factor(error: str) -> int | None:
    """Return the downsampling that an error of `volumes.load` proposes."""
    import re

    found = re.search(r"downsample=(\d+)", error)
    return int(found.group(1)) if found else None


def _open_raw(application: Application, session: Session, message: dict[str, Any]) -> list[Message]:
    """Open the uploaded file of raw voxels with the header that the user typed."""
    path = application.upload.path
    if path is None or message.get("size") is None:
        application.upload.clear()
        return []
    settings: dict[str, Any] = {"size": tuple(message["size"]), "dtype": str(message.get("dtype"))}
    settings |= {"spacing": tuple(message.get("spacing") or (1, 1, 1))}
    settings |= {"offset": int(message.get("offset") or 0)}
    answers = _open_volume(application, session, path, **settings)
    application.upload.clear()
    return answers


def _has_header(path: Path) -> bool:
    """Return whether a .vol file is Mitsuba's."""
    with path.open("rb") as stream:
        return stream.read(3) == b"VOL"


def _guess_cube(count: int) -> list[int]:
    """Return the size of a cube of as many bytes, one each, or 256³."""
    side = round(count ** (1 / 3))
    return [side] * 3 if side**3 == count else [256] * 3
