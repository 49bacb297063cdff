"""Makes `Lights` from the numbers in files, and checks them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.lights import Lights

FEWEST = 3  # lights with which a normal can be found
# Share of lights behind the object above which the file is wrong, rather than a few of the lights
MOST_BEHIND = 0.25
SMALLEST_SPREAD = 0.02  # ratio of singular values of directions that do not lie in a plane
EQUAL_LENGTHS = 1.02  # ratio of lengths up to which vectors are directions alone
COUNT_ADVICE = "there should be one for each"


def make_distant_lights(
    path: Path, directions: FloatArray, intensities: FloatArray | None = None
) -> Lights:
    """Return distant lights in `directions` (k, 3) of any length, by default of equal intensity.

    `path` is the file of the directions. Raises `BrdfkitError` for vectors without a direction.
    """
    directions = np.asarray(directions, float)
    lengths = np.linalg.norm(directions, axis=1)
    bad = ~np.isfinite(lengths) | (lengths == 0)
    if bad.any():
        raise BrdfkitError(
            f"{path}: the vector of light {1 + int(np.argmax(bad))} has no direction, as it is "
            "zero or not finite; mend it, or leave that light out."
        )
    unit = directions / lengths[:, None]
    return Lights(unit, np.ones_like(unit) if intensities is None else intensities)


def find_lengths(vectors: FloatArray) -> FloatArray | None:
    """Return the lengths (k,) of vectors (k, 3) to lights if they differ, otherwise None."""
    lengths: FloatArray = np.linalg.norm(vectors, axis=1)
    return lengths if lengths.max() > EQUAL_LENGTHS * lengths.min() else None


def to_intensities(path: Path, numbers: FloatArray, count: int) -> FloatArray:
    """Return intensities (count, 3) from the numbers (count, 1) or (count, 3) in a file.

    Raises `BrdfkitError` for another shape, and for intensities that are not above 0.
    """
    if len(numbers) != count and numbers.size == count:
        numbers = numbers.reshape(count, 1)
    if len(numbers) != count:
        raise BrdfkitError(
            f"{path}: it has intensities of {len(numbers)} lights, and there are {count} "
            f"photographs; {COUNT_ADVICE}."
        )
    if numbers.shape[1] not in (1, 3):
        raise BrdfkitError(
            f"{path}: each light has {numbers.shape[1]} intensities; give one, or red, green and "
            "blue."
        )
    if (numbers < 0).any() or not (numbers > 0).any(axis=1).all():
        raise BrdfkitError(f"{path}: each light needs an intensity above 0, and none below.")
    return np.broadcast_to(numbers, (count, 3)).copy()


def check_count(path: Path, lights: int, photographs: Sequence[object]) -> None:
    """Raise `BrdfkitError` unless there are as many lights, of the file `path`, as photographs."""
    if lights != len(photographs):
        raise BrdfkitError(
            f"{path}: it has {lights} lights, and there are {len(photographs)} photographs; "
            f"{COUNT_ADVICE}."
        )


def find_lights_in_front(path: Path, lights: Lights) -> BoolArray:
    """Return which lights (k,) are in front of the object, with z above 0.

    Raises `BrdfkitError` if many are behind it, because then z of the file does not point to the
    camera.
    """
    in_front: BoolArray = lights.directions[:, 2] > 0
    behind = int((~in_front).sum())
    if behind > MOST_BEHIND * len(lights):
        raise BrdfkitError(
            f"{path}: {behind} of {len(lights)} lights are behind the object; x should point to "
            "the right in the photographs, y up, and z from the object to the camera."
        )
    return in_front


def check_spread(path: Path, lights: Lights) -> None:
    """Raise `BrdfkitError` for fewer than three lights, or lights in directions in one plane."""
    if len(lights) < FEWEST:
        raise BrdfkitError(
            f"{path}: only {len(lights)} photographs with a light are left, and normals need "
            f"{FEWEST} or more."
        )
    spread = np.linalg.svd(lights.directions, compute_uv=False)
    if spread[2] < SMALLEST_SPREAD * spread[0]:
        raise BrdfkitError(
            f"{path}: the directions of all lights lie in one plane, which leaves the normals "
            "open; add lights from other sides."
        )
