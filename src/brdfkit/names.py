"""Names: apart from each other, fit to be printed, fit for a file."""

CONTROL = {chr(c) for c in (*range(32), *range(127, 160))}  # ASCII's, ISO 6429's: a terminal obeys
RESERVED = '/\\:*?"<>|'  # no part of a file's name, here or on another system
LONGEST = 100  # bytes: a file system takes 255, with suffix and all


def unused(name, taken):
    """`name`, numbered where it is among `taken`: "ward", "ward (2)".

    >>> unused("ward", {"ward"})
    'ward (2)'
    """
    number, result = 1, name
    while result in taken:
        number += 1
        result = f"{name} ({number})"
    return result


def printable(text, keep=""):
    """`text` without control characters, which a file could send to the terminal, but `keep`.

    >>> printable("gold\\x1b[2J")
    'gold[2J'
    """
    return "".join(c for c in str(text) if c in keep or c not in CONTROL)


def slug(name):
    """A file's name, without suffix, after a material's: never empty, too long or elsewhere.

    >>> slug("../gold: matte")
    '-gold- matte'
    """
    fit = "".join("-" if c in RESERVED or not c.isprintable() else c for c in name)
    short = fit.strip(". ").encode()[:LONGEST].decode(errors="ignore")
    return short.rstrip(". ") or "material"
