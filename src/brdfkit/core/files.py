"""Writes files whole or not at all, and reads them up to a size limit, unpacked if needed."""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from brdfkit.core.errors import BrdfkitError, find_nearest_name

SIZE_LIMIT = 2**30  # most bytes that are read, decompressed; the largest MERL table has 70 MB
CHUNK_SIZE = 2**20  # bytes
GZIP, XZ = ".gz", ".xz"
# A function that is called with the path of a file before or after it is written
Watcher = Callable[[Path], object]
_watchers: ContextVar[tuple[tuple[Watcher, Watcher], ...]] = ContextVar("watchers", default=())
COMPRESSED = {GZIP: b"\x1f\x8b", XZ: b"\xfd7zXZ\x00"}  # suffix → first bytes of such files


@contextmanager
def write_safely(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path beside `path`, which is renamed to it when the block succeeded.

    If the block is interrupted, also by Ctrl-C, an older file at `path` stays as it was and no
    other file is left. The temporary path has the suffix of `path`, for libraries that choose a
    format by it. Raises `BrdfkitError` where the file cannot be written, and for an `OSError`
    inside the block.

    >>> with write_safely("copper.json") as beside:  # doctest: +SKIP
    ...     beside.write_text("{}")
    """
    target = require_writable(path)
    with _link_as_utf8(target.parent) as folder:
        beside = folder / f".brdfkit-{os.urandom(4).hex()}{target.suffix}"
        try:
            beside.touch(exist_ok=False)
            yield beside
            os.replace(beside, target)
            for _, after in _watchers.get():
                after(target)
        except OSError as error:
            raise BrdfkitError(
                f"{path}: cannot be written ({_describe_cause(error)}); choose another folder or "
                "make room."
            ) from error
        finally:
            with suppress(OSError):
                beside.unlink()


@contextmanager
def _link_as_utf8(folder: Path) -> Iterator[Path]:
    """Yield a path of the folder that native libraries can read, in UTF-8: if necessary, a link."""
    if is_utf8_path(folder):
        yield folder
        return
    from tempfile import TemporaryDirectory  # imported here to keep `--help` fast

    with TemporaryDirectory(prefix="brdfkit-") as place:
        link = Path(place) / "folder"
        link.symlink_to(folder, target_is_directory=True)
        yield link


def is_utf8_path(path: str | os.PathLike[str]) -> bool:
    """Return whether the bytes of a path are UTF-8, as native libraries such as Mitsuba need."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        return False
    return True


def make_folder(path: str | os.PathLike[str]) -> None:
    """Make a folder for results unless it exists.

    Raises `BrdfkitError` where no file can be written to it.

    >>> make_folder("results")
    """
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
        if not os.access(path, os.W_OK):
            raise PermissionError("it is write-protected")
    except OSError as error:
        raise BrdfkitError(
            f"{path}: cannot be made a folder for results ({_describe_cause(error)}); name another."
        ) from error


def require_writable(path: str | os.PathLike[str]) -> Path:
    """Check before a long computation that `write_safely` can write `path`; return the real path.

    For a link, that is the file to which it leads. Raises `BrdfkitError` for each failure that can
    be foreseen.
    """
    try:
        os.fsencode(path)
        target = Path(os.path.realpath(path))
        if target.is_symlink():
            raise BrdfkitError(f"{path}: is a link that leads to itself; choose another name.")
        if not target.parent.is_dir():
            raise BrdfkitError(f"{path}: there is no folder {target.parent}; create it first.")
        if target.exists() and not target.is_file():
            raise BrdfkitError(f"{path}: is no regular file; choose another name.")
        if target.exists() and not os.access(target, os.W_OK):
            raise BrdfkitError(f"{path}: is write-protected; choose another name.")
        if not os.access(target.parent, os.W_OK | os.X_OK):
            raise BrdfkitError(f"{path}: the folder is write-protected; choose another one.")
        for before, _ in _watchers.get():
            before(target)
    except OSError as error:
        raise BrdfkitError(
            f"{path}: cannot be written ({_describe_cause(error)}); choose another folder or name."
        ) from error
    except UnicodeEncodeError:
        raise BrdfkitError(
            f"{str(path)!a}: this system's locale has no such file names; choose one of plain "
            "letters, or set LC_ALL=C.UTF-8."
        ) from None
    return target


@contextmanager
def watch_writing(before: Watcher, after: Watcher) -> Iterator[None]:
    """Within the block, call `before(path)` and `after(path)` around the writing of every file.

    `before` is also called as soon as it is known that a file will be written. It may raise a
    `BrdfkitError`: then the file stays as it is.
    """
    token = _watchers.set((*_watchers.get(), (before, after)))
    try:
        yield
    finally:
        _watchers.reset(token)


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Read a file, decompressed if it is gzip or xz by its name or its first bytes.

    Raises `BrdfkitError` for a file that is missing, not regular, unreadable, empty, damaged, or
    larger than `SIZE_LIMIT` bytes. A plain file that is too large is not read at all; decompression
    stops at the limit.

    >>> read_bytes("gold.binary.xz")[:4]  # doctest: +SKIP
    b'Z\\x00\\x00\\x00'
    """
    path = require_file(path)
    with _translate_read_errors(path):
        data = _read_unpacked(path)
    if not data:
        raise BrdfkitError(f"{path}: the file is empty; fetch it again.")
    return data


def compute_sha256(path: str | os.PathLike[str]) -> str:
    """Compute the SHA-256 of a file, in hexadecimal.

    Raises `BrdfkitError` for a file that is missing, not regular or unreadable.
    """
    import hashlib  # imported here to keep `--help` fast

    path = require_file(path)
    with _translate_read_errors(path), path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def require_unchanged(checksums: Mapping[str, str]) -> None:
    """Raise `BrdfkitError` if a file has changed; `checksums` are the expected SHA-256 by path."""
    for path, checksum in checksums.items():
        if compute_sha256(path) != checksum:
            raise BrdfkitError(f"{path}: has changed since the work began; begin it again.")


@contextmanager
def _translate_read_errors(path: Path) -> Iterator[None]:
    """Turn an `OSError` inside the block, which reads the file at `path`, into a `BrdfkitError`."""
    try:
        yield
    except OSError as error:
        raise BrdfkitError(
            f"{path}: cannot be read ({_describe_cause(error)}); check its permissions."
        ) from error


def require_file(path: str | os.PathLike[str]) -> Path:
    """Return the `Path` of a regular file.

    Raises `BrdfkitError` where there is none; it proposes the file beside it with a similar name.
    """
    path = Path(path)
    with _translate_read_errors(path):
        if path.is_dir():
            raise BrdfkitError(f"{path}: is a folder; name a file in it.")
        if path.is_file():
            return path
        if path.exists():
            raise BrdfkitError(f"{path}: is no regular file; name one.")
        beside = {file.name for file in path.parent.glob("*")} if path.parent.is_dir() else set()
    near = find_nearest_name(path.name, sorted(beside - {path.name}))
    remedy = f"did you mean {path.with_name(near)}? Else check" if near else "check"
    raise BrdfkitError(f"{path}: there is no such file; {remedy} the path.")


def _read_unpacked(path: Path) -> bytes:
    """Read the bytes of a file, decompressed, up to `SIZE_LIMIT`."""
    with path.open("rb") as stream:
        first = stream.read(8)
    for suffix, magic in COMPRESSED.items():
        if first and (path.suffix.lower() == suffix or first.startswith(magic)):
            return _decompress(path, suffix)
    if path.stat().st_size > SIZE_LIMIT:
        raise _too_large_error(path)
    return path.read_bytes()


def _decompress(path: Path, suffix: str) -> bytes:
    """Decompress a file up to `SIZE_LIMIT` bytes, since a small file may unpack to terabytes."""
    import gzip  # imported here to keep `--help` fast
    import lzma
    import zlib

    data = bytearray()
    try:
        with (gzip.open if suffix == GZIP else lzma.open)(path) as stream:
            while chunk := stream.read(CHUNK_SIZE):
                data += chunk
                if len(data) > SIZE_LIMIT:
                    raise _too_large_error(path)
    except (gzip.BadGzipFile, zlib.error, lzma.LZMAError, EOFError) as error:
        raise BrdfkitError(
            f"{path}: the compressed data are damaged or cut short ({_describe_cause(error)}); "
            "fetch the file again."
        ) from error
    return bytes(data)


def _too_large_error(path: Path) -> BrdfkitError:
    """Return the error for a file that is too large."""
    return BrdfkitError(
        f"{path}: holds more than {SIZE_LIMIT:,} bytes, which no BRDF file needs; "
        "check that it is the right file."
    )


def _describe_cause(error: BaseException) -> str:
    """Return why an error happened: the system's reason, or else the error's own message."""
    return getattr(error, "strerror", None) or str(error).strip().rstrip(".") or "unknown cause"
