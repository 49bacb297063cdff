"""`RemoteFile` reads parts of a file on a server, to get one member of a large zip archive."""

import io
from typing import Any
from zipfile import BadZipFile

import requests

BLOCK = 2**22  # bytes per request; small blocks need many requests, whose number servers limit
TIMEOUT = 30  # seconds to wait for an answer
PARTIAL = 206  # HTTP status of an answer with a part of the file
# Ask for bytes without compression, because positions count the bytes of the file
PLAIN = {"Accept-Encoding": "identity"}


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
            if answer.status_code != PARTIAL:  # the whole archive would come, perhaps gigabytes
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
