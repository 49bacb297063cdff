"""Finds what a user's text means: a file, or one of the names that brdfkit knows."""

import os
from collections.abc import Iterable
from pathlib import Path

from brdfkit.core.arguments import wrong_value_error
from brdfkit.core.errors import no_such_error
from brdfkit.core.files import require_file


def find_file_or_name(
    given: object, what: str, known: Iterable[str], folders: bool = False
) -> Path | str:
    """Return what `given` means: an existing file as a `Path`, or else one of the `known` names.

    `what` is the kind of thing in errors, such as "material". With `folders`, a folder takes
    precedence over a known name as well. Raises `BrdfkitError`, which proposes the nearest name,
    where there is neither a file nor a name.

    >>> find_file_or_name("studio", "environment map", ["studio"])
    'studio'
    """
    known = list(known)
    if not isinstance(given, str | os.PathLike) or not str(given):
        names = f", or one of {', '.join(known)}" if known else ""
        raise wrong_value_error(what, given, f"the path of a file{names}")
    path, name = Path(given), os.fspath(given)
    if os.path.exists(path) if folders else os.path.isfile(path):
        return path
    if name in known:
        return name
    if looks_like_name(name):
        raise no_such_error(f"file or {what}", name, known)
    return require_file(path)


def looks_like_name(text: str) -> bool:
    """Return whether a text is one word, without folder and suffix, and names no file."""
    path = Path(text)
    return len(path.parts) == 1 and not path.suffix and not os.path.exists(path)


def split_file_and_part(text: str | os.PathLike[str]) -> tuple[Path, str | None]:
    """Split "FILE#PART" into the path and the name of the part; None where there is no part.

    A '#' in the name of an existing file, or in the name of a folder, belongs to the path.

    >>> split_file_and_part("abrdf.dat#12")
    (PosixPath('abrdf.dat'), '12')
    """
    whole = os.fspath(text)
    file, hash_sign, part = whole.rpartition("#")
    is_path = not (hash_sign and os.path.basename(file)) or os.path.exists(whole)
    if is_path or ("/" in part and not os.path.exists(file)):
        return Path(whole), None
    return Path(file), part
