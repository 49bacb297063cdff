"""Folders of PSBox: photographs of objects and of chrome balls beside them, under the same lights.

``Objects/`` has the photographs, ``light_directions.txt`` a column for each light (x to the right,
y up, z towards the camera), and ``light_strength.txt`` its strength. Without the directions they
are found from the photographs in ``LightProbe-1`` and so on, where ``circle_data.txt`` has the
centre of the ball (column and row, from the lower left, beginning at 1) and its radius.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.chrome_ball import find_light_directions_in_circle
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.making_lights import (
    check_count,
    make_distant_lights,
    to_intensities,
)
from brdfkit.inverse.photographs.capture.number_table import read_number_table, read_vectors
from brdfkit.inverse.photographs.capture.pictures.masks import find_mask_file
from brdfkit.inverse.photographs.capture.pictures.photograph_file import list_photographs

NAME = "PSBox"
OBJECTS, PROBES = "Objects", "LightProbe-*"
DIRECTIONS, STRENGTHS, CIRCLE = "light_directions.txt", "light_strength.txt", "circle_data.txt"
REFERENCE = "ref"  # stem of a photograph of a probe in the light of the room


def find_listing(folder: Path) -> Listing | None:
    """Return the `Listing` of a folder of PSBox or of the folder Objects in it, or None."""
    root = folder.resolve().parent if folder.resolve().name == OBJECTS else folder
    objects = root / OBJECTS
    if not objects.is_dir() or not ((root / DIRECTIONS).is_file() or [*root.glob(PROBES)]):
        return None
    photographs = list_photographs(objects)
    path, directions, notes = _find_directions(root, len(photographs))
    check_count(path, len(directions), photographs)
    strengths, intensities = root / STRENGTHS, None
    if strengths.is_file():
        numbers = read_number_table(strengths).numbers
        intensities = to_intensities(strengths, numbers, len(photographs))
    return Listing(
        name=folder.resolve().name,
        photographs=photographs,
        lights=make_distant_lights(path, directions, intensities),
        lights_file=path,
        has_intensities=intensities is not None,
        mask=find_mask_file(objects),
        notes=notes,
    )


def _find_directions(root: Path, count: int) -> tuple[Path, FloatArray, tuple[str, ...]]:
    """Return the file of the directions (k, 3) of `count` lights, these, and notes on them."""
    if (root / DIRECTIONS).is_file():
        return root / DIRECTIONS, read_vectors(root / DIRECTIONS, count).numbers[:, :3], ()
    probes = sorted(root.glob(PROBES))
    found = [_find_directions_by_probe(probe) for probe in probes]
    if len({len(directions) for directions in found}) > 1:
        raise BrdfkitError(f"{root}: its probes have different numbers of photographs.")
    note = f"the lights were found from chrome balls in {', '.join(p.name for p in probes)}."
    return probes[0], np.mean(found, axis=0), (note,)


def _find_directions_by_probe(probe: Path) -> FloatArray:
    """Return the directions (k, 3) of lights by a chrome ball in the photographs of a folder."""
    balls = tuple(p for p in list_photographs(probe) if p.stem.lower() != REFERENCE)
    circle = read_number_table(probe / CIRCLE).numbers.ravel()
    if circle.size != 3:
        raise BrdfkitError(
            f"{probe / CIRCLE}: it should have three numbers, column and row of the centre of the "
            "ball and its radius."
        )
    return find_light_directions_in_circle(balls, circle[:2], circle[2])
