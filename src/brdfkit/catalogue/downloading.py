"""Files of public collections: from where they are published into the user's cache folder.

`pooch` checks the checksum and puts a file in its place. What it lacks is here: an interrupted
download of a file goes on where it stopped, and one file of a zip archive is fetched alone.
"""

import io
import os
import zlib
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit
from zipfile import BadZipFile, ZipFile

import pooch
import requests

from brdfkit.catalogue import public
from brdfkit.catalogue.public import PART, Listed
from brdfkit.catalogue.remote import BLOCK, PARTIAL, PLAIN, TIMEOUT, RemoteFile
from brdfkit.errors import BrdfkitError

CHUNK = 2**18  # bytes
NOTHING_LEFT = 416  # HTTP's answer to a request for what is behind the end


def get(name, progress=None):
    """Download a material of a public collection; returns the path of its file.

    `progress` is called with (done, total) bytes, the total None where it is not known. A file that
    is here and right is left alone. Raises `BrdfkitError`: one sentence that says what to do
    where there is no address to download from, no connection, or the wrong file comes.

    >>> get("merl/alum-bronze").name    # doctest: +SKIP
    'alum-bronze.binary'
    """
    owner = public.collection(name)
    listed = owner.files.get(name)
    if listed is None or not listed.url:
        return public.path(name)  # where a person put it, or the sentence to do so
    pooch.get_logger().setLevel("WARNING")
    with _told(listed, owner):
        pooch.retrieve(
            listed.url,
            known_hash=f"sha256:{listed.sha256}" if listed.sha256 else None,
            fname=listed.file,
            path=listed.path.parent,
            downloader=_Download(listed, progress or (lambda done, total: None)),
        )
    return listed.path


@contextmanager
def _told(listed, owner):
    """Turns what may go wrong into one sentence."""
    by_hand = owner.by_hand(listed.file)
    try:
        yield
    except BrdfkitError:
        raise
    except requests.HTTPError as error:
        status = error.response.status_code
        raise BrdfkitError(
            f"{listed.name}: {_host(listed)} answers {status} {error.response.reason}; "
            f"try again later, or {by_hand}."
        ) from error
    except requests.RequestException as error:
        raise BrdfkitError(
            f"{listed.name}: the connection to {_host(listed)} failed; check it and run the "
            f"command again, or {by_hand}."
        ) from error
    except (BadZipFile, KeyError, NotImplementedError, EOFError, zlib.error) as error:
        raise BrdfkitError(
            f"{listed.name}: {_host(listed)} does not give this file of its archive; {by_hand}."
        ) from error
    except ValueError as error:  # pooch's, about the checksum
        raise BrdfkitError(
            f"{listed.name}: what {_host(listed)} sent is not the file that was published (its "
            f"checksum differs), and was removed; run the command again, or {by_hand}."
        ) from error
    except OSError as error:
        raise BrdfkitError(
            f"{listed.path}: cannot be written ({error.strerror or error}); make room or permit it."
        ) from error


def _host(listed):
    return urlsplit(listed.url).hostname


@dataclass(frozen=True)
class _Download:
    """What pooch calls with the address and the file to write."""

    listed: Listed
    progress: Callable

    def __call__(self, url, target, _pooch):
        archive, _, member = url.partition("#")
        if member:
            self._member(archive, member, target)
        else:
            self._file(url, Path(target))

    def _file(self, url, target):
        """The whole file, or what is missing of it."""
        part = self.listed.path.with_name(self.listed.file + PART)
        # without a checksum nothing would tell whether two halves belong together
        have = part.stat().st_size if self.listed.sha256 and part.is_file() else 0
        headers = PLAIN | ({"Range": f"bytes={have}-"} if have else {})
        with requests.get(url, headers=headers, stream=True, timeout=TIMEOUT) as answer:
            if answer.status_code != NOTHING_LEFT:
                answer.raise_for_status()
                self._write(answer, part, have if answer.status_code == PARTIAL else 0)
        os.replace(part, target)

    def _write(self, answer, part, have):
        length = answer.headers.get("Content-Length")
        total = have + int(length) if length else None
        with part.open("ab" if have else "wb") as stream:
            for chunk in answer.iter_content(CHUNK):
                stream.write(chunk)
                have += len(chunk)
                self.progress(have, total)

    def _member(self, url, member, target):
        with ZipFile(io.BufferedReader(RemoteFile(url), BLOCK)) as archive:
            total = archive.getinfo(member).file_size
            with archive.open(member) as source, open(target, "wb") as stream:
                while chunk := source.read(CHUNK):
                    stream.write(chunk)
                    self.progress(stream.tell(), total)
