"""Opens the files that the page sends: volumes, environment maps, transfer functions and settings.

The files of one drop that belong to a volume, such as the slices of a scan, or a header and its
voxels, become one volume.
"""

from __future__ import annotations

import json
import os
import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.core.arguments import to_positive_number, to_whole_number, wrong_value_error
from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.volumes.source import load_within_memory
from brdfkit.volumes import formats
from brdfkit.volumes.formats.dicom import find_series_description
from brdfkit.volumes.formats.raw import IN_NAME
from brdfkit.volumes.loading import looks_like_volume

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.session import Session

    Application = Any  # `VolumeApplication`, which imports this file

RAW = ".raw", ".bin", ".dat", ".img", ".vol"  # suffixes of files without a header
HEADERS = ".mhd", ".nhdr", ".hdr"  # suffixes of headers beside a file of voxels
DTYPES = "uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"


def load_upload(
    application: Application, session: Session, message: dict[str, Any], data: bytes
) -> list[Message]:
    """Take a piece of a file, and open the files of a drop after their last piece."""
    upload = application.upload
    if not upload.add(message, data):
        return [({"type": "uploaded"}, [])]
    folder = upload.folder.name
    try:
        return _open_drop(application, session)
    except BrdfkitError as error:  # the folder means nothing to the user
        text = str(error).replace(f"{folder}{os.sep}", "").replace(folder, "the dropped files")
        raise BrdfkitError(text) from error
    finally:
        if upload.raw is None:
            upload.clear()


def load_raw(application: Application, session: Session, message: dict[str, Any]) -> list[Message]:
    """Open the file of voxels that waits for its header, as the user typed it; None cancels."""
    upload = application.upload
    try:
        if upload.raw is None or message.get("size") is None:
            return []
        settings = {
            "size": _read_triple(message, "size", partial(to_whole_number, least=1)),
            "dtype": message.get("dtype"),
            "spacing": _read_triple(message, "spacing", to_positive_number),
            "offset": to_whole_number("offset", message.get("offset", 0), 0),
        }
        if settings["dtype"] not in DTYPES:
            raise wrong_value_error("type", settings["dtype"], f"one of {', '.join(DTYPES)}")
        return _open_volume(application, session, upload.raw, **settings)
    finally:
        upload.clear()


def _read_triple(
    message: dict[str, Any], name: str, check: Callable[[str, Any], float]
) -> tuple[float, ...]:
    """Return three numbers of a message, each of which passes a check."""
    values = message.get(name)
    if not isinstance(values, list) or len(values) != 3:
        raise wrong_value_error(name, values, "three numbers")
    return tuple(check(name, value) for value in values)


def _open_drop(application: Application, session: Session) -> list[Message]:
    """Open the files of a drop: its volume, and then the others one by one."""
    messages: list[Message] = []
    files = [(path, _choose_kind(path, kind)) for path, kind in application.upload.files]
    voxels = [path for path, kind in files if kind == "volume"]
    if voxels:
        path = _choose_volume(voxels)
        if path.is_file() and path.suffix.lower() in RAW and not formats.is_recognised(path):
            application.upload.raw = path
            messages.append(_ask_for_header(path))
        else:
            messages += _open_volume(application, session, path)
    openers = {"environment": _open_environment, "transfer": _open_transfer, "state": _open_state}
    for path, kind in files:
        if kind != "volume":
            if kind not in openers:
                raise BrdfkitError(f"{path.name}: the page sent an unknown kind of file; reload.")
            messages += openers[kind](application, session, path)
    return messages


def _choose_kind(path: Path, kind: str) -> str:
    """Return the kind of a file. A .hdr may be an environment map, or the header of a scan."""
    return "volume" if kind == "environment" and looks_like_volume(str(path)) else kind


def _choose_volume(files: list[Path]) -> Path:
    """Return the file of a drop to open as a volume: the only one, its header, or the folder."""
    headers = [path for path in files if path.suffix.lower() in HEADERS]
    if len(files) > 1 and len(headers) != 1:
        return files[0].parent
    return headers[0] if headers else files[0]


def _ask_for_header(path: Path) -> Message:
    """Return the question how the voxels of a file are stored, with a guess."""
    count, named = path.stat().st_size, IN_NAME.search(path.name)
    guess = {"size": _guess_cube(count), "dtype": "uint8", "spacing": [1, 1, 1]}
    if named:
        guess |= {"size": [int(named[k]) for k in (1, 2, 3)], "dtype": named[4]}
    question = {"type": "ask_raw", "name": path.name, "bytes": count}
    return question | {"guess": guess, "dtypes": DTYPES}, []


def _guess_cube(count: int) -> list[int]:
    """Return the size of a cube of as many bytes, one each, or 256³."""
    side = round(count ** (1 / 3))
    return [side] * 3 if side**3 == count else [256] * 3


def _open_volume(
    application: Application, session: Session, path: Path, **settings: Any
) -> list[Message]:
    """Show the volume of a file or folder."""
    with formats.confine_headers(), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            volume, source = load_within_memory(path, **settings)
        except formats.UnknownFormatError as error:
            raise BrdfkitError(
                f"{path}: is no file that the page opens: it opens volumes, which are "
                f"{formats.describe_formats()}, environment maps (.hdr .exr), and transfer "
                "functions and settings (.json)."
            ) from error
    name = path.name
    if path.is_dir():
        name = _name_series(application.upload.files)
        volume = replace(volume, name=name)
    notes = [str(warning.message) for warning in caught]
    if path.is_file() and volume.size[2] == 1:
        notes.append(f"{name} is one slice: drop all files of a scan together, or their folder.")
    application.show(volume, replace(source, path=name, uploaded=True))
    notes += application.doubts()
    session.open(application.first_state())
    errors: list[Message] = [({"type": "error", "text": " ".join(notes)}, [])] if notes else []
    return [session.describe_view(), *errors]


def _name_series(files: list[tuple[Path, str]]) -> str:
    """Return the name of a volume of several files: its series' description, or the first file's.

    Characters that names of files cannot have are replaced.
    """
    first = min(path for path, kind in files if kind == "volume")
    description = find_series_description(first)
    return re.sub(r'[\x00-\x1f/\\:*?"<>|]+', "_", description).strip(" ._") or first.stem


def _open_environment(application: Application, session: Session, path: Path) -> list[Message]:
    """Light the volume by an environment map; it replaces an older one of its name."""
    application.add_environment(path)
    session.change({"light.environment": path.name})
    session.forget_samples()
    return [session.describe_view()]


def _open_transfer(application: Application, session: Session, path: Path) -> list[Message]:
    """Show the volume with a transfer function, brdfkit's or the bumps of the program VPT."""
    bumps = read_vpt_bumps(path)
    if bumps is not None:
        session.change({"transfer.mode": "bumps2d", "transfer.bumps": bumps})
        return [session.describe_state()]
    application.states.functions.add(path)
    session.change({"transfer.preset": path.name})
    session.forget_samples()
    return [session.describe_view()]


def _open_state(application: Application, session: Session, path: Path) -> list[Message]:
    """Show the volume with the settings of a file."""
    try:
        changes = json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        raise BrdfkitError(
            f"{path.name}: is no JSON ({error}); choose settings of a view."
        ) from None
    if not isinstance(changes, dict):
        raise BrdfkitError(f"{path.name}: has no settings by name; choose settings of a view.")
    return session.handle({"type": "set", "changes": changes, "moving": False})


def read_vpt_bumps(path: Path) -> list[dict[str, Any]] | None:
    """Read the bumps that the program VPT [Lesar 2018] saved, or None for another file.

    Such a file is a list of {position: {x, y}, size: {x, y}, color: {r, g, b, a}}, from 0 to 1.
    """
    try:
        records = json.loads(path.read_bytes())
        if not isinstance(records, list):
            return None
        return [
            {
                **{"x": r["position"]["x"], "y": r["position"]["y"]},
                **{"sx": r["size"]["x"], "sy": r["size"]["y"], "a": r["color"]["a"]},
                "colour": "#" + "".join(_to_hex(r["color"][c]) for c in "rgb"),
            }
            for r in records
        ]
    except (ValueError, RecursionError, TypeError, KeyError):
        return None


def _to_hex(component: float) -> str:
    """Return a colour's component as two hexadecimal digits; VPT keeps it from 0 to 1."""
    return f"{round(255 * min(max(component, 0), 1)):02x}"
