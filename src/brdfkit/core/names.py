"""Makes names unique, printable, fit for a file, and lists of them."""

from pathlib import Path

CONTROL = {chr(c) for c in (*range(32), *range(127, 160))}  # ASCII, ISO 6429: a terminal obeys
RESERVED = '/\\:*?"<>|'  # not allowed in a file name, here or on another system
LONGEST = 100  # bytes: a file system takes 255, with suffix and all


def make_unique(name, taken):
    """`name`, or `name` with the first number by which it is not among `taken`.

    >>> make_unique("ward", {"ward"})
    'ward (2)'
    """
    number, result = 1, name
    while result in taken:
        number += 1
        result = f"{name} ({number})"
    return result


def format_percent(percent):
    """A percentage in words, with two digits where it is small.

    >>> format_percent(0.0312), format_percent(41.3), format_percent(100)
    ('0.031 %', '41 %', '100 %')
    """
    return f"{percent:.2g} %" if percent < 10 else f"{percent:.0f} %"


def to_printable(text, keep=""):
    """`text` without control characters, by which a file could steer the terminal.

    The control characters in `keep` stay. Bytes of a file's name that are no UTF-8, which Python
    has as lone surrogates, become question marks.

    >>> to_printable("gold\\x1b[2J")
    'gold[2J'
    """
    shown = "".join(c for c in str(text) if c in keep or c not in CONTROL)
    return shown.encode(errors="replace").decode()


def join_words(words):
    """Words as a list in a sentence.

    >>> join_words(["log", "cbrt", "plain"])
    'log, cbrt and plain'
    """
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def to_file_stem(name):
    """A file name without suffix for a material's `name`: not empty, not too long, in no folder.

    >>> to_file_stem("../gold: matte")
    '-gold- matte'
    """
    fit = "".join("-" if c in RESERVED or not c.isprintable() else c for c in name)
    short = fit.strip(". ").encode()[:LONGEST].decode(errors="ignore")
    return short.rstrip(". ") or "material"


def to_fit_path(folder, label):
    """The path in `folder` of a saved fit; no colons, which some file systems refuse.

    >>> to_fit_path("copper", "koenderink:order=8").name
    'koenderink-order=8.json'
    """
    return Path(folder) / f"{label.replace(':', '-')}.json"
