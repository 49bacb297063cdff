"""`Source`: where the volume of a view comes from; and its loading within the memory."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from brdfkit import volumes
from brdfkit.core.array_types import AnyArray
from brdfkit.volumes import Volume
from brdfkit.volumes.loading import TooLargeError

# Bytes of a voxel in a view: as a 32-bit float with its gradient magnitude, in Mitsuba as well
VOXEL_BYTES = 20


@dataclass(frozen=True)
class Source:
    """The file, folder or name of a volume, with the other arguments of `brdfkit.volumes.load`.

    `uploaded`: whether the page sent it, so that its folder is unknown.
    """

    path: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    uploaded: bool = False


def find_volume(volume: Volume | AnyArray | str | Path) -> tuple[Volume, Source | None]:
    """Return the volume that a user means: itself, an array's, or that of a file or name."""
    if isinstance(volume, Volume):
        return volume, None
    if isinstance(volume, np.ndarray):
        return Volume(volume), None
    return load_within_memory(volume)


def load_within_memory(
    path: str | Path, downsample: int = 1, **settings: Any
) -> tuple[Volume, Source]:
    """Load a volume for a view, averaged to fewer voxels if there is too little memory.

    Warns if more voxels are averaged than `downsample` says. `settings` are other arguments of
    `brdfkit.volumes.load`.
    """
    factor = downsample
    try:
        volume = volumes.load(path, downsample=factor, **settings)
    except TooLargeError as error:
        if error.downsample is None:
            raise
        factor = error.downsample
        volume = volumes.load(path, downsample=factor, **settings)
    more = 1
    while VOXEL_BYTES * volume.values.size / more**3 > psutil.virtual_memory().available:
        more += 1
    if more > 1:
        volume, factor = volume.resized(more), factor * more
    if factor > downsample:
        warnings.warn(
            f"{volume.name} is too large for the memory, and {factor}³ voxels become one.",
            stacklevel=2,
        )
    if factor > 1:
        settings["downsample"] = factor
    return volume, Source(str(path), settings)
