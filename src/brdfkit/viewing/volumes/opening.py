"""Opens the volumes that the page sends.

The files of one drop that belong to a volume, such as the slices of a scan, or a header and its
voxels, become one volume.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from brdfkit.core.arguments import to_positive_number, to_whole_number, wrong_value_error
from brdfkit.viewing.application import Message
from brdfkit.viewing.kinds import RAW
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.viewing.volumes.source import load_within_memory
from brdfkit.volumes import formats
from brdfkit.volumes.formats.dicom import find_series_description
from brdfkit.volumes.formats.raw import IN_NAME

HEADERS = ".mhd", ".nhdr", ".hdr"  # suffixes of headers beside a file of voxels
DTYPES = "uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"


def read_header(message: dict[str, Any]) -> dict[str, Any]:
    """Return how voxels are stored, as the user typed it, as arguments of `volumes.load`."""
    settings = {
        "size": _read_triple(message, "size", partial(to_whole_number, least=1)),
        "dtype": message.get("dtype"),
        "spacing": _read_triple(message, "spacing", to_positive_number),
        "offset": to_whole_number("offset", message.get("offset", 0), 0),
    }
    if settings["dtype"] not in DTYPES:
        raise wrong_value_error("type", settings["dtype"], f"one of {', '.join(DTYPES)}")
    return settings


def _read_triple(
    message: dict[str, Any], name: str, check: Callable[[str, Any], float]
) -> tuple[float, ...]:
    """Return three numbers of a message, each of which passes a check."""
    values = message.get(name)
    if not isinstance(values, list) or len(values) != 3:
        raise wrong_value_error(name, values, "three numbers")
    return tuple(check(name, value) for value in values)


def choose_volume(files: list[Path]) -> Path:
    """Return the file of a drop to open as a volume: the only one, its header, or the folder."""
    headers = [path for path in files if path.suffix.lower() in HEADERS]
    if len(files) > 1 and len(headers) != 1:
        return files[0].parent
    return headers[0] if headers else files[0]


def needs_header(path: Path) -> bool:
    """Return whether a file holds voxels alone, so that the user is asked how they are stored."""
    return path.is_file() and path.suffix.lower() in RAW and not formats.is_recognised(path)


def ask_for_header(path: Path) -> Message:
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


def open_volume(path: Path, files: list[Path], **settings: Any) -> VolumeApplication:
    """Return the view of a dropped file or folder, whose voxels are in `files`.

    Warns of what the user should know.
    """
    with formats.confine_headers():
        volume, source = load_within_memory(path, **settings)
    name = path.name
    if path.is_dir():
        name = _name_series(files)
        volume = replace(volume, name=name)
    elif volume.size[2] == 1:
        note = f"{name} is one slice: drop all files of a scan together, or their folder."
        warnings.warn(note, stacklevel=2)
    return VolumeApplication(volume, replace(source, path=name, uploaded=True))


def _name_series(files: list[Path]) -> str:
    """Return the name of a volume of several files: its series' description, or the first file's.

    Characters that names of files cannot have are replaced.
    """
    first = min(files)
    description = find_series_description(first)
    return re.sub(r'[\x00-\x1f/\\:*?"<>|]+', "_", description).strip(" ._") or first.stem
