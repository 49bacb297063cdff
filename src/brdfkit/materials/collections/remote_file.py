"""`RemoteFile`: a file on a server, read by HTTP ranges, for one member of a large archive."""

import io
from zipfile import BadZipFile

import requests

BLOCK = 2**22  # bytes per request: servers limit their number
TIMEOUT = 30  # seconds without an answer
PARTIAL = 206  # HTTP status of an answer with a part of the file
PLAIN = {"Accept-Encoding": "identity"}  # uncompressed, so that positions are those of the file


class RemoteFile(io.RawIOBase):
    """The file at `url`, seekable. `zipfile` reads it through an `io.BufferedReader`.

    Raises the errors of `requests`, and `BadZipFile` where the server sends whole files only.
    """

    def __init__(self, url):
        self.url, self.position = url, 0
        _, content_range = self._read_range(0, 0)
        self.size = int(content_range.rpartition("/")[2])

    def _read_range(self, first, last):
        """The bytes from `first` to `last` included, and the answer's Content-Range header."""
        headers = PLAIN | {"Range": f"bytes={first}-{last}"}
        with requests.get(self.url, headers=headers, stream=True, timeout=TIMEOUT) as answer:
            answer.raise_for_status()
            if answer.status_code != PARTIAL:  # the whole archive would come, perhaps gigabytes
                raise BadZipFile("the server sends no parts")
            return answer.content, answer.headers["Content-Range"]

    def readable(self):
        return True

    def seekable(self):
        return True

    def tell(self):
        return self.position

    def seek(self, offset, whence=io.SEEK_SET):
        origin = {io.SEEK_SET: 0, io.SEEK_CUR: self.position, io.SEEK_END: self.size}[whence]
        self.position = origin + offset
        return self.position

    def readinto(self, buffer):
        count = min(len(buffer), self.size - self.position)
        if count <= 0:
            return 0
        data, _ = self._read_range(self.position, self.position + count - 1)
        buffer[: len(data)] = data
        self.position += len(data)
        return len(data)
