"""Tables of named columns separated by tabs, `.tsv`: as `.csv` in all else (see there)."""

from typing import IO

from brdfkit.materials.formats import csv
from brdfkit.materials.formats._delimited import find_delimiter
from brdfkit.materials.formats._source import Source
from brdfkit.materials.measured import Measured

NAME = "TSV"
SUFFIXES = (".tsv",)


def sniff(head: bytes) -> bool:
    """Return whether a line of `head`, with tabs, names columns that give both directions."""
    return find_delimiter(head) == "\t"


def read(source: Source) -> Measured:
    """Read the samples as a `Measured`."""
    return csv.read(source, NAME)


def write(obj: object, stream: IO[bytes]) -> None:
    """Write the valid samples of a `Measured`, in its own channels."""
    csv.write(obj, stream, NAME, "\t")
