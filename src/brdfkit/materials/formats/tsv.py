"""Tables of named columns separated by tabs, `.tsv`: as `.csv` in all else (see there)."""

from brdfkit.materials.formats import csv
from brdfkit.materials.formats._delimited import find_delimiter

NAME = "TSV"
SUFFIXES = (".tsv",)


def sniff(head):
    """Whether a line of `head`, with tabs, names columns that give both directions."""
    return find_delimiter(head) == "\t"


def read(source):
    """The samples as `Measured`."""
    return csv.read(source, NAME)


def write(obj, stream):
    """Write the valid samples of a `Measured`, in its own channels."""
    csv.write(obj, stream, NAME, "\t")
