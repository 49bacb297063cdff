"""Defines `Listing`, what the text files of a folder say about the photographs in it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.lights import Lights


@dataclass(frozen=True, eq=False)
class Listing:
    """The photographs of an object in a folder, with their lights.

    Attributes
    ----------
    name : str
        Name of the object.
    photographs : tuple of Path
        The files of the photographs.
    lights : Lights
        The light of each photograph.
    lights_file : Path
        The file that says where the lights are, for errors and notes.
    has_intensities : bool
        Whether that file, or another one, states the intensities of the lights.
    lengths : ndarray, shape (lights,), optional
        Lengths of the vectors to the lights in that file, if they differ and nothing says why.
    is_ordered_by_number : bool
        Whether the lights were given to the photographs in the order of the numbers in their names.
    mask : Path, optional
        The file of the mask.
    normals : ndarray, shape (height, width, 3), optional
        The true normals, where they are known.
    pixel_size, distance : float, optional
        See `ObjectCapture`.
    width : float, optional
        The width of the object in the mask [m].
    fov : float, optional
        The angle across the width of a photograph [degrees].
    notes : tuple of str
        Sentences on what was found so far.
    """

    name: str
    photographs: tuple[Path, ...]
    lights: Lights
    lights_file: Path
    has_intensities: bool = False
    lengths: FloatArray | None = None
    is_ordered_by_number: bool = False
    mask: Path | None = None
    normals: FloatArray | None = None
    pixel_size: float | None = None
    distance: float | None = None
    width: float | None = None
    fov: float | None = None
    notes: tuple[str, ...] = ()
