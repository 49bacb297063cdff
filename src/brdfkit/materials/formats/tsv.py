"""Tables of text with named columns that tabs separate, `.tsv`; `csv.py` describes the columns."""

from typing import IO

from brdfkit.materials.formats import csv
from brdfkit.materials.formats._delimited import detect_delimiter
from brdfkit.materials.formats._source import Source
from brdfkit.materials.measured import Measured

NAME = "TSV"
SUFFIXES = (".tsv",)


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with `head` is a table of BRDF samples with tabs."""
    return detect_delimiter(head) == "\t"


def read(source: Source) -> Measured:
    """Read a table with tabs as a `Measured`."""
    return csv.read(source, NAME)


def write(obj: object, stream: IO[bytes]) -> None:
    """Write the valid samples of a `Measured` as a table with tabs, in its own channels."""
    csv.write(obj, stream, NAME, "\t")
