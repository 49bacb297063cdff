"""Protects files: a command must not overwrite its inputs, or other files without --force.

For each file that a command writes, a small file in the user's cache folder records its checksum
and the command line. Therefore the same command may replace its own files without --force, and
continue where it was stopped.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import click

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import compute_sha256

# Options that do not change the contents of files
NEUTRAL_OPTIONS = "force", "as_json", "quiet", "workers"
# The key in click's context of the files that the running command wrote
WRITTEN = "brdfkit.written"
# Text files that refer to other files, and the largest one that is searched for them [bytes]
REFERRING = ".xml", ".toml", ".json", ".nhdr", ".mhd", ".vti", ".obj", ".mtl"
TEXT_SIZE_LIMIT = 2**22
WORDS = re.compile(r"\"([^\"\n]+)\"|'([^'\n]+)'|([^\s\"'<>=]+)")


def refuse_to_replace(target: Path) -> None:
    """Raise `BrdfkitError` where the running command must not write the file `target`.

    It must not replace a file that it reads, or, without --force, one that it did not write.
    """
    context = click.get_current_context(silent=True)
    if context is None or not target.exists() or _is_in_cache(target):
        return
    if _was_written_by(target, context):
        return
    if _is_input(target, context.params):
        raise BrdfkitError(f"{_shorten_path(target)} is a file to read; name another to write.")
    if context.params.get("force"):
        return
    raise BrdfkitError(
        f"{_shorten_path(target)} exists already, and another command wrote it: name another file, "
        "or add --force to replace it."
    )


def _shorten_path(target: Path) -> Path:
    """Return a file's path relative to the current folder, if the file is in that folder."""
    here = Path.cwd()
    return target.relative_to(here) if target.is_relative_to(here) else target


def record_writing(target: Path) -> None:
    """Record in the cache folder that the running command wrote the file `target`."""
    context = click.get_current_context(silent=True)
    if context is None or _is_in_cache(target):
        return
    context.meta.setdefault(WRITTEN, set()).add(target)
    with suppress(OSError, BrdfkitError):  # without a cache folder, --force will be needed
        record = _find_record_path(target)
        record.parent.mkdir(parents=True, exist_ok=True)
        written = {
            "file": str(target),
            "origin": _describe_command(context),
            "sha256": compute_sha256(target),
        }
        record.write_text(json.dumps(written), encoding="utf-8")


def _is_in_cache(target: Path) -> bool:
    """Return whether a file lies in brdfkit's cache folder."""
    # Imported only here, because the module loads slowly
    from brdfkit.materials.collections.public import find_cache_folder

    return target.is_relative_to(find_cache_folder().resolve())


def _was_written_by(target: Path, context: click.Context) -> bool:
    """Return whether this command wrote the file, and no other program changed it since."""
    if target in context.meta.get(WRITTEN, ()):
        return True
    try:
        written = json.loads(_find_record_path(target).read_text(encoding="utf-8"))
        # The command is compared first, because a checksum takes seconds for a large file
        same_command = written["origin"] == _describe_command(context)
        return same_command and written["sha256"] == compute_sha256(target)
    except (OSError, ValueError, KeyError, TypeError, BrdfkitError):
        return False


def _find_record_path(target: Path) -> Path:
    """Return the path in the cache folder of the record on the file `target`."""
    # Imported only here, because the module loads slowly
    from brdfkit.materials.collections.public import find_cache_folder

    name = hashlib.sha256(os.fsencode(target)).hexdigest()[:32]
    return find_cache_folder() / "written" / f"{name}.json"


def _describe_command(context: click.Context) -> str:
    """Return the running command line as a text that does not depend on the order of options."""
    options = {n: v for n, v in sorted(context.params.items()) if n not in NEUTRAL_OPTIONS}
    return f"{context.info_name} {json.dumps(options, default=str)} in {Path.cwd()}"


def _is_input(target: Path, parameters: Mapping[str, Any]) -> bool:
    """Return whether a command with these `parameters` reads the file `target`."""
    inputs = (value for name, value in parameters.items() if name != "output")
    return any(target.samefile(path) for path in _list_inputs(inputs))


def _list_inputs(words: Any) -> Iterator[Path]:
    """Yield the files that arguments name, files in named folders, and files named in these."""
    waiting, known = [Path(word) for word in _list_texts(words)], set()
    while waiting:
        path = _resolve_existing_path(waiting.pop())
        if path is None or path in known:
            continue
        known.add(path)
        if path.is_dir():
            waiting += [file for file in path.iterdir() if file.is_file()]
            continue
        yield path
        if path.suffix.lower() in REFERRING and path.stat().st_size <= TEXT_SIZE_LIMIT:
            text = path.read_text(encoding="utf-8", errors="replace")
            waiting += [path.parent / next(filter(None, groups)) for groups in WORDS.findall(text)]


def _list_texts(value: Any) -> Iterator[str]:
    """Yield the texts in values of arguments, and their parts before # and after =."""
    if isinstance(value, str | Path):
        text = str(value)
        yield text
        yield from (text.rpartition(sign)[0] for sign in "#" if sign in text)
        yield from (text.partition(sign)[2] for sign in "=" if sign in text)
    elif not isinstance(value, dict) and hasattr(value, "__iter__"):
        for part in value:
            yield from _list_texts(part)


def _resolve_existing_path(path: Path) -> Path | None:
    """Return the path without links of an existing file or folder, and None otherwise."""
    with suppress(OSError, ValueError):  # a text that is no file name, such as a too long one
        return path.resolve() if path.is_file() or path.is_dir() else None
    return None
