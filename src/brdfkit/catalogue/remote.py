"""A file on a server, read in parts: one member of a large archive."""

import io
from zipfile import BadZipFile

import requests

BLOCK = 2**22  # bytes to ask for at once: servers count requests
TIMEOUT = 30  # seconds without an answer
PARTIAL = 206  # HTTP's answer to a request for a part
PLAIN = {"Accept-Encoding": "identity"}  # sizes and positions are those of the file


class RemoteFile(io.RawIOBase):
    """What `zipfile` reads, behind an `io.BufferedReader` of `BLOCK` bytes.

    Raises what `requests` raises, and `BadZipFile` where the server sends whole files only.
    """

    def __init__(self, url):
        self.url, self.position = url, 0
        _, content_range = self._part(0, 0)
        self.size = int(content_range.rpartition("/")[2])

    def _part(self, first, last):
        """The bytes from `first` to `last`, and what the server says that they are."""
        headers = PLAIN | {"Range": f"bytes={first}-{last}"}
        with requests.get(self.url, headers=headers, stream=True, timeout=TIMEOUT) as answer:
            answer.raise_for_status()
            if answer.status_code != PARTIAL:  # all of a gigabyte would come
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
        data, _ = self._part(self.position, self.position + count - 1)
        buffer[: len(data)] = data
        self.position += len(data)
        return len(data)
