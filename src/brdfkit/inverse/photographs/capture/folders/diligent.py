"""Folders of the DiLiGenT benchmark: linear photographs of 16 bits with calibrated distant lights.

``filenames.txt`` lists the photographs, ``light_directions.txt`` has unit vectors (x to the right,
y up, z towards the camera), ``light_intensities.txt`` red, green and blue of each light, by which
the photographs are not yet divided. ``Normal_gt.mat`` holds the true normals [Shi et al. 2019].
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.making_lights import (
    check_count,
    make_distant_lights,
    to_intensities,
)
from brdfkit.inverse.photographs.capture.number_table import (
    read_number_table,
    read_vectors,
    read_words,
)

NAME = "DiLiGenT"
FILE_NAMES, DIRECTIONS = "filenames.txt", "light_directions.txt"
INTENSITIES, NORMALS, MASK = "light_intensities.txt", "Normal_gt.mat", "mask.png"


def find_listing(folder: Path) -> Listing | None:
    """Return the `Listing` of a folder of DiLiGenT, or None for another folder."""
    if not ((folder / FILE_NAMES).is_file() and (folder / DIRECTIONS).is_file()):
        return None
    names = [" ".join(words) for words in read_words(folder / FILE_NAMES)]
    photographs = tuple(require_file(folder / name) for name in names)
    path, strengths = folder / DIRECTIONS, folder / INTENSITIES
    directions = read_vectors(path, len(photographs)).numbers[:, :3]
    check_count(path, len(directions), photographs)
    known = strengths.is_file()
    intensities = None
    if known:
        numbers = read_number_table(strengths).numbers
        intensities = to_intensities(strengths, numbers, len(photographs))
    mask, normals = folder / MASK, folder / NORMALS
    return Listing(
        name=folder.name.removesuffix("PNG") or folder.name,
        photographs=photographs,
        lights=make_distant_lights(path, directions, intensities),
        lights_file=path,
        has_intensities=known,
        mask=mask if mask.is_file() else None,
        normals=read_normals(normals) if normals.is_file() else None,
    )


def read_normals(path: Path) -> FloatArray:
    """Read the normals (height, width, 3) in a file of Matlab, which holds one such array.

    Raises `BrdfkitError` for a file without such an array.
    """
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        content = loadmat(path)
    except (MatReadError, ValueError, TypeError, OSError, NotImplementedError) as error:
        raise BrdfkitError(
            f"{path}: it is no file of Matlab up to version 7, or it is damaged; fetch it again, "
            "or delete it, as the fit does not need it."
        ) from error
    arrays = [np.asarray(value) for name, value in content.items() if not name.startswith("__")]
    found = [array for array in arrays if array.ndim == 3 and array.shape[2] == 3]
    if len(found) != 1 or found[0].dtype.kind != "f":
        raise BrdfkitError(
            f"{path}: there is no array of normals (height, width, 3) in it; delete it, as the fit "
            "does not need it."
        )
    return np.asarray(found[0], float)
