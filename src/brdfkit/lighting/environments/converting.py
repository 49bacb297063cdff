"""`environments.convert` writes an environment map in the convention of another program."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from brdfkit.core.arguments import to_number, to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.environments.conventions import parse_convention
from brdfkit.lighting.environments.cubes import Cube
from brdfkit.lighting.environments.map_files import load_radiance, write_map
from brdfkit.lighting.environments.resampling import resample

LARGEST_HEIGHT = 16_384  # rows of a written map; more are probably a typing error


def convert(
    environment: str | Path | NDArray[Any],
    path: str | Path,
    *,
    source: str = "mitsuba",
    target: str = "mitsuba",
    height: int | None = None,
    turn: float = 0.0,
    mirror: bool = False,
) -> Path:
    """Write an environment map in the convention of another program, or in another layout.

    Light keeps its direction in the world. A world with z up is turned into one with y up as
    exporters do: (x, y, z) → (x, z, -y). A convention is the name of a program, such as
    ``blender``, or of a layout, such as ``cross``, optionally followed by the axes of the world
    that are right, up and ahead, as in ``latlong:+x+y-z``. The default axes are Mitsuba's.

    Parameters
    ----------
    environment : str, Path or ndarray
        The map: a file, the name of a map that comes with brdfkit, or radiance
        (height, width, 3) in linear sRGB.
    path : str or Path
        The file to write, `.exr`.
    source, target : str, default "mitsuba"
        The conventions of the map that is read, and of the map that is written.
    height : int, optional
        Rows of the written picture. By default, pixels along the horizon keep their size.
    turn : float, default 0
        Angle by which the light turns about the up axis, anticlockwise seen from above [degrees].
        For instance, 180/1024 is half a column of a map of 1024 columns.
    mirror : bool, default False
        Whether to exchange left and right of the source.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    BrdfkitError
        If a convention is unknown (the error lists all), or if the map cannot be read, does not
        have the shape of its layout, or has negative or infinite radiance. Nothing is written then.

    Examples
    --------
    >>> environments.convert("sky", "sky_cross.exr", target="cross")    # doctest: +SKIP
    """
    before, after = parse_convention(source), parse_convention(target)
    turn = to_number("turn", turn)
    _, rgb = load_radiance(environment, before.layout.aspect)
    if height is None:
        quarter = round(rgb.shape[0] / before.layout.rows)
        same = before.layout.rows == after.layout.rows
        height = rgb.shape[0] if same else max(2, int(quarter * after.layout.rows))
    height = to_whole_number("height", height, least=2)
    if height > LARGEST_HEIGHT:
        raise BrdfkitError(f"height = {height} is more than {LARGEST_HEIGHT} rows; give fewer.")
    if isinstance(after.layout, Cube) and height % after.layout.lines:
        raise BrdfkitError(
            f"height = {height} should be a multiple of {after.layout.lines}, the number of faces "
            f"from top to bottom of {target}."
        )
    return write_map(resample(rgb, before, after, height, turn, mirror), path)
