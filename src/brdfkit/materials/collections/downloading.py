"""Downloads files of public collections into the user's cache folder.

The package `pooch` verifies the checksum and moves the file to its place. This module makes an
interrupted download resume, and downloads one file of a zip archive without the rest of it.
"""

import io
import os
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from zipfile import BadZipFile, ZipFile

import pooch
import requests

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.collections import public
from brdfkit.materials.collections.public import PART, Collection, ListedFile

CHUNK = 2**18  # number of bytes that are written to disk at once
BLOCK = 2**22  # number of bytes per request; it is large because servers limit the requests
TIMEOUT = 30  # seconds to wait for a server's answer
PARTIAL = 206  # HTTP status of an answer with a part of the file
# HTTP header that asks for the file's bytes without compression, so that positions can be computed
PLAIN = {"Accept-Encoding": "identity"}
RANGE_NOT_SATISFIABLE = 416  # HTTP status where the requested part begins at the file's end

# A function that reports progress: it gets the number of bytes done, and the number of all bytes or
# None where it is unknown
Report = Callable[[int, int | None], object]


def download(name: str, progress: Report | None = None) -> Path:
    """Download a material of a public collection, and return the path of its file.

    For a folder of photographs all of its files are downloaded, and its path is returned.
    `progress` is called with the number of bytes done and the number of all bytes, which is None
    where the server does not state it. A file with the right checksum is not downloaded again.
    Raises `BrdfkitError`, which says what to do, where no address is known, the connection fails,
    or the server sends another file.

    >>> download("merl/alum-bronze").name    # doctest: +SKIP
    'alum-bronze.binary'
    """
    owner = public.find_collection(name)
    if name in owner.folders:
        _download_files(owner.folders[name], owner, progress)
        return public.find_folder(name)
    listed = owner.files.get(name)
    if listed is None or not listed.url:
        # Return the file that the user has put there, or raise an error that explains how to get it
        return public.find_file(name)
    _download_file(listed, owner, progress or (lambda done, total: None))
    return listed.path


def _download_files(
    files: Sequence[ListedFile], owner: Collection, progress: Report | None
) -> None:
    """Download the files of a folder of photographs, whose sizes are known."""
    total = sum(listed.bytes for listed in files)
    before = 0
    for listed in files:

        def report(done: int, _: int | None, before: int = before) -> None:
            """Report the bytes of this file together with those of the files before."""
            if progress is not None:
                progress(before + done, total)

        _download_file(listed, owner, report)
        before += listed.bytes


def _download_file(listed: ListedFile, owner: Collection, progress: Report) -> None:
    """Download a listed file, unless it is there with the right checksum."""
    pooch.get_logger().setLevel("WARNING")
    with _explain_errors(listed, owner):
        pooch.retrieve(
            listed.url,
            known_hash=f"sha256:{listed.sha256}" if listed.sha256 else None,
            fname=listed.path.name,
            path=listed.path.parent,
            downloader=_Download(listed, progress),
        )


@contextmanager
def _explain_errors(listed: ListedFile, owner: Collection) -> Iterator[None]:
    """Turn errors of downloading the file `listed` into a `BrdfkitError` that says what to do."""
    by_hand = owner.explain_manual_fetch(listed.file)
    host = urlsplit(listed.url).hostname
    try:
        yield
    except BrdfkitError:
        raise
    except requests.HTTPError as error:
        status = error.response.status_code
        raise BrdfkitError(
            f"{listed.name}: {host} answers {status} {error.response.reason}; "
            f"try again later, or {by_hand}."
        ) from error
    except requests.RequestException as error:
        raise BrdfkitError(
            f"{listed.name}: the connection to {host} failed; check it and run the "
            f"command again, or {by_hand}."
        ) from error
    except (BadZipFile, KeyError, NotImplementedError, EOFError, zlib.error) as error:
        raise BrdfkitError(
            f"{listed.name}: {host} does not give this file of its archive; {by_hand}."
        ) from error
    except ValueError as error:  # pooch raises it for a file with another checksum
        raise BrdfkitError(
            f"{listed.name}: what {host} sent is not the file that was published (its "
            f"checksum differs), and was removed; run the command again, or {by_hand}."
        ) from error
    except OSError as error:
        raise BrdfkitError(
            f"{listed.path}: cannot be written ({error.strerror or error}); make room or permit it."
        ) from error


@dataclass(frozen=True)
class _Download:
    """Downloads one file; pooch calls it as its `downloader`, with a URL and the file to write.

    `listed`: entry of the file in the index; `progress`: function that reports the bytes done.
    """

    listed: ListedFile
    progress: Report

    def __call__(self, url: str, target: str, _pooch: Any) -> None:
        archive, _, member = url.partition("#")
        if member:
            self._fetch_member(archive, member, target)
        else:
            self._fetch_file(url, Path(target))

    def _fetch_file(self, url: str, target: Path) -> None:
        """Download the file at `url` to `target`, resuming an interrupted download."""
        part = self.listed.path.with_name(self.listed.path.name + PART)
        # Resume an interrupted download only if a checksum can prove that its parts fit together
        have = part.stat().st_size if self.listed.sha256 and part.is_file() else 0
        headers = PLAIN | ({"Range": f"bytes={have}-"} if have else {})
        with requests.get(url, headers=headers, stream=True, timeout=TIMEOUT) as answer:
            if answer.status_code != RANGE_NOT_SATISFIABLE:
                answer.raise_for_status()
                self._append_answer_to_file(
                    answer, part, have if answer.status_code == PARTIAL else 0
                )
        os.replace(part, target)

    def _append_answer_to_file(self, answer: requests.Response, part: Path, have: int) -> None:
        """Append the server's `answer` to the incomplete file `part`, which has `have` bytes."""
        length = answer.headers.get("Content-Length")
        total = have + int(length) if length else None
        with part.open("ab" if have else "wb") as stream:
            for chunk in answer.iter_content(CHUNK):
                stream.write(chunk)
                have += len(chunk)
                self.progress(have, total)

    def _fetch_member(self, url: str, member: str, target: str) -> None:
        """Download the file `member` of the zip archive at `url` to `target`."""
        with ZipFile(io.BufferedReader(RemoteFile(url), BLOCK)) as archive:
            total = archive.getinfo(member).file_size
            with archive.open(member) as source, open(target, "wb") as stream:
                while chunk := source.read(CHUNK):
                    stream.write(chunk)
                    self.progress(stream.tell(), total)


class RemoteFile(io.RawIOBase):
    """A binary stream of the file at `url`, which requests only the parts that are read.

    `zipfile` reads it through an `io.BufferedReader`. Raises the errors of `requests`, and
    `BadZipFile` where the server sends whole files only.
    """

    def __init__(self, url: str) -> None:
        self.url, self.position = url, 0
        _, content_range = self._read_range(0, 0)
        self.size = int(content_range.rpartition("/")[2])

    def _read_range(self, first: int, last: int) -> tuple[bytes, str]:
        """Request the bytes `first` to `last`, both included, from the server.

        The second result is the answer's header Content-Range, which states the file's size.
        """
        headers = PLAIN | {"Range": f"bytes={first}-{last}"}
        with requests.get(self.url, headers=headers, stream=True, timeout=TIMEOUT) as answer:
            answer.raise_for_status()
            if answer.status_code != PARTIAL:  # the server would send all of perhaps gigabytes
                raise BadZipFile("the server sends no parts")
            return answer.content, answer.headers["Content-Range"]

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self.position

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        origin = {io.SEEK_SET: 0, io.SEEK_CUR: self.position, io.SEEK_END: self.size}[whence]
        self.position = origin + offset
        return self.position

    def readinto(self, buffer: Any) -> int:
        count = min(len(buffer), self.size - self.position)
        if count <= 0:
            return 0
        data, _ = self._read_range(self.position, self.position + count - 1)
        buffer[: len(data)] = data
        self.position += len(data)
        return len(data)
