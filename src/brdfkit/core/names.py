"""Makes names unique, printable or fit for files, and joins words to lists."""

from collections.abc import Collection, Sequence
from pathlib import Path

# The control characters of ASCII and ISO 6429
CONTROL = {chr(c) for c in (*range(32), *range(127, 160))}
RESERVED = '/\\:*?"<>|'  # characters that some systems refuse in file names
LONGEST_STEM = 100  # bytes of a stem; file systems allow 255 with the suffix


def make_unique(name: str, taken: Collection[str]) -> str:
    """Return `name`, or if it is `taken`, the name with the first free number behind it.

    >>> make_unique("ward", {"ward"})
    'ward (2)'
    """
    number, result = 1, name
    while result in taken:
        number += 1
        result = f"{name} ({number})"
    return result


def format_percent(percent: float) -> str:
    """Format a percentage, with two significant digits below 10 and as a whole number above.

    >>> format_percent(0.0312), format_percent(41.3), format_percent(100)
    ('0.031 %', '41 %', '100 %')
    """
    return f"{percent:.2g} %" if percent < 10 else f"{percent:.0f} %"


def to_printable(text: object, keep: str = "") -> str:
    """Remove the control characters from a text, since a file could steer the terminal by them.

    The control characters in `keep` stay. Bytes in a file's name that are not UTF-8, which Python
    represents as lone surrogates, become question marks.

    >>> to_printable("gold\\x1b[2J")
    'gold[2J'
    """
    shown = "".join(c for c in str(text) if c in keep or c not in CONTROL)
    return shown.encode(errors="replace").decode()


def join_words(words: Sequence[str]) -> str:
    """Join words to a list in a sentence.

    >>> join_words(["log", "cbrt", "plain"])
    'log, cbrt and plain'
    """
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def to_file_stem(name: str) -> str:
    """Turn a material's name into a file name without suffix and folder, neither empty nor long.

    >>> to_file_stem("../gold: matte")
    '-gold- matte'
    """
    fit = "".join("-" if c in RESERVED or not c.isprintable() else c for c in name)
    short = fit.strip(". ").encode()[:LONGEST_STEM].decode(errors="ignore")
    return short.rstrip(". ") or "material"


def to_fit_path(folder: str | Path, label: str) -> Path:
    """Return the path in `folder` of a saved fit; colons, which some systems refuse, become "-".

    >>> to_fit_path("copper", "koenderink:order=8").name
    'koenderink-order=8.json'
    """
    return Path(folder) / f"{label.replace(':', '-')}.json"
