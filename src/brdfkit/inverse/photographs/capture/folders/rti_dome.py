"""Folders of reflectance transformation imaging (RTI): a file .lp lists photographs and lights.

Its first line is the number of photographs. Each other line has the name of a photograph and x, y
and z of its light, as a unit vector or a position: x to the right, y up, z towards the camera.
"""

from __future__ import annotations

import re
from pathlib import Path, PureWindowsPath

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.making_lights import find_lengths, make_distant_lights
from brdfkit.inverse.photographs.capture.number_table import read_lines
from brdfkit.inverse.photographs.capture.pictures.masks import find_mask_file

NAME = "a file .lp of RTI"
SUFFIX = ".lp"
LINE = re.compile(r"(.*\S)[\s,;]+([^\s,;]+)[\s,;]+([^\s,;]+)[\s,;]+([^\s,;]+)")


def find_listing(folder: Path) -> Listing | None:
    """Return the `Listing` of a folder with a file .lp, also in a folder in it, or None."""
    found = sorted({*folder.glob(f"*{SUFFIX}")} or {*folder.glob(f"*/*{SUFFIX}")})
    if not found:
        return None
    if len(found) > 1:
        raise BrdfkitError(
            f"{folder}: there are {len(found)} files of lights, such as {found[0].name} and "
            f"{found[1].name}; leave one of them."
        )
    path = found[0]
    names, vectors = read_lp(path)
    return Listing(
        name=folder.resolve().name,
        photographs=tuple(_find_photograph(folder, path, name) for name in names),
        lights=make_distant_lights(path, vectors),
        lights_file=path,
        lengths=find_lengths(vectors),
        mask=find_mask_file(folder),
    )


def read_lp(path: Path) -> tuple[list[str], FloatArray]:
    """Return the names of photographs and the vectors (k, 3) of the lights in a file .lp.

    Raises `BrdfkitError` for a line that is odd, and for another number than the first line has.
    """
    first, *lines = read_lines(path) or [""]
    if not first.isdigit():
        raise BrdfkitError(
            f"{path}: its first line is {first[:40]!r}, and should be the number of photographs."
        )
    names, vectors = [], []
    for number, line in enumerate(lines, 2):
        found = LINE.fullmatch(line)
        try:
            vector = [float(word) for word in found.groups()[1:]] if found else []
        except ValueError:
            vector = []
        if found is None or not np.isfinite(vector).all() or not vector:
            raise BrdfkitError(
                f"{path}: line {number} should have the name of a photograph and three finite "
                f"numbers, and is {line[:60]!r}; mend it."
            )
        names.append(found.group(1))
        vectors.append(vector)
    if len(names) != int(first):
        raise BrdfkitError(
            f"{path}: its first line promises {first} photographs, and {len(names)} follow; mend "
            "the number, or fetch the file again."
        )
    return names, np.array(vectors).reshape(-1, 3)


def _find_photograph(folder: Path, path: Path, name: str) -> Path:
    """Return the photograph that the file at `path` names, perhaps by a path of another computer.

    It is looked for beside that file, in `folder` and in the folders in it.
    """
    own = PureWindowsPath(name).name  # understands / and \
    places = (path.parent / name.replace("\\", "/"), path.parent / own, folder / own)
    for place in (*places, *sorted(folder.glob(f"*/{own}"))):
        if place.is_file():
            return place
    return require_file(path.parent / own)  # raises the error
