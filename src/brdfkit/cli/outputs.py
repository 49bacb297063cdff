"""Guards files: no command writes one that it reads, or replaces another command's unasked.

What a command wrote is remembered in the user's cache folder: a small file for each output has its
checksum and the command line. So the same command may replace its own files, and goes on where it
was stopped; for any other file that is there already it asks for --force.
"""

import hashlib
import json
import os
import re
from contextlib import suppress
from pathlib import Path

import click

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import sha256

# Options that say where the output goes and how it is printed, not what it is
NOT_ORIGIN = "force", "as_json", "quiet", "jobs"
# Where click's context has the files that the running command wrote
WRITTEN = "brdfkit.written"
# Text files that refer to other files, which are read, too; so much of a text is looked at
REFERRING, LARGEST_TEXT = (".xml", ".toml", ".json", ".nhdr", ".mhd", ".vti", ".obj", ".mtl"), 2**22
WORDS = re.compile(r"\"([^\"\n]+)\"|'([^'\n]+)'|([^\s\"'<>=]+)")


def refuse_to_replace(target):
    """Raise `BrdfkitError` where the running command should not write the file `target`: where it
    reads it, or where the file is there already, of another origin and without --force."""
    context = click.get_current_context(silent=True)
    if context is None or not target.exists() or _is_ours(target) or _is_own(target, context):
        return
    if _is_input(target, context.params):
        raise BrdfkitError(f"{_shown(target)} is a file to read; name another to write.")
    if context.params.get("force"):
        return
    raise BrdfkitError(
        f"{_shown(target)} is there already, and not of this command: name another file, or add "
        "--force to replace it."
    )


def _shown(target):
    """The path of a file as the user would write it."""
    here = Path.cwd()
    return target.relative_to(here) if target.is_relative_to(here) else target


def remember(target):
    """Remember the file `target` as one that the running command wrote."""
    context = click.get_current_context(silent=True)
    if context is None or _is_ours(target):
        return
    context.meta.setdefault(WRITTEN, set()).add(target)
    with suppress(OSError, BrdfkitError):  # without a cache folder --force is asked for
        record = _record_of(target)
        record.parent.mkdir(parents=True, exist_ok=True)
        written = {"file": str(target), "origin": _origin(context), "sha256": sha256(target)}
        record.write_text(json.dumps(written), encoding="utf-8")


def _is_ours(target):
    """Whether a file is brdfkit's own, in the user's cache folder."""
    from brdfkit.materials.collections.public import cache_folder  # only here: it is slow

    return target.is_relative_to(cache_folder().resolve())


def _is_own(target, context):
    """Whether this command wrote the file, just now or, as it is, the last time."""
    if target in context.meta.get(WRITTEN, ()):
        return True
    try:
        written = json.loads(_record_of(target).read_text(encoding="utf-8"))
        return written["origin"] == _origin(context) and written["sha256"] == sha256(target)
    except (OSError, ValueError, KeyError, TypeError, BrdfkitError):
        return False


def _record_of(target):
    from brdfkit.materials.collections.public import cache_folder  # only here: it is slow

    name = hashlib.sha256(os.fsencode(target)).hexdigest()[:32]
    return cache_folder() / "written" / f"{name}.json"


def _origin(context):
    """The command line of the running command, in a normal form."""
    given = {n: v for n, v in sorted(context.params.items()) if n not in NOT_ORIGIN}
    return f"{context.info_name} {json.dumps(given, default=str)} in {Path.cwd()}"


def _is_input(target, parameters):
    """Whether a file is one of those that a command with these `parameters` reads."""
    given = (value for name, value in parameters.items() if name != "output")
    return any(target.samefile(path) for path in _files_read(given))


def _files_read(words):
    """Yield the files that arguments name, those in a folder, and those that they refer to."""
    waiting, known = [Path(word) for word in _texts(words)], set()
    while waiting:
        path = _existing(waiting.pop())
        if path is None or path in known:
            continue
        known.add(path)
        if path.is_dir():
            waiting += [file for file in path.iterdir() if file.is_file()]
            continue
        yield path
        if path.suffix.lower() in REFERRING and path.stat().st_size <= LARGEST_TEXT:
            text = path.read_text(encoding="utf-8", errors="replace")
            waiting += [path.parent / next(filter(None, found)) for found in WORDS.findall(text)]


def _texts(value):
    """Yield the texts in arguments as click has them: what stands before # or behind = too."""
    if isinstance(value, str | Path):
        text = str(value)
        yield text
        yield from (text.rpartition(sign)[0] for sign in "#" if sign in text)
        yield from (text.partition(sign)[2] for sign in "=" if sign in text)
    elif not isinstance(value, dict) and hasattr(value, "__iter__"):
        for part in value:
            yield from _texts(part)


def _existing(path):
    """The path of a file or a folder that is there, without links; None for any other text."""
    with suppress(OSError, ValueError):  # too long for a name, or with a null character
        return path.resolve() if path.is_file() or path.is_dir() else None
    return None
