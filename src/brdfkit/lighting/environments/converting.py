"""`environments.convert`: writes an environment map in the convention of another program."""

from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from brdfkit.core.arguments import to_number, to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.environments.conventions import convention
from brdfkit.lighting.environments.cubes import Cube
from brdfkit.lighting.environments.map_files import load_light, write
from brdfkit.lighting.environments.resampling import resample

# Rows of a map: more are a mistake
LARGEST = 16_384


def convert(
    environment: str | Path | NDArray[Any],
    path: str | Path,
    source: str = "mitsuba",
    target: str = "mitsuba",
    height: int | None = None,
    turn: float = 0.0,
    mirror: bool = False,
) -> Path:
    """Write an environment map in the convention of another program, or in another layout.

    Light keeps its direction in the world; a world with z up is turned to one with y up as
    exporters do, (x, y, z) → (x, z, -y). A convention is the name of a program, as ``blender``, or
    of a layout, as ``cross`` or ``angular``, with the axes of the world that are right, up and
    ahead in it, as ``latlong:+x+y-z``; without axes, with those of Mitsuba.

    Parameters
    ----------
    environment : str, Path or ndarray
        The map: a file, the name of a map that comes with brdfkit, or radiance
        (height, width, 3) in linear sRGB.
    path : str or Path
        The file to write, `.exr`.
    source, target : str, default "mitsuba"
        The conventions of the map as it is, and as it is written.
    height : int, optional
        Rows of the written picture; by default, pixels along the horizon stay as large.
    turn : float, default 0
        Turns the light about the up axis, anticlockwise seen from above [degrees]; half a column
        of a map of 1024 is 180/1024.
    mirror : bool, default False
        Whether left and right of the source are exchanged.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    BrdfkitError
        For an unknown convention, which names all; for a map that cannot be read, has
        another shape than its layout, or has radiance that is negative or not finite; then nothing
        is written.

    Examples
    --------
    >>> environments.convert("sky", "sky_cross.exr", target="cross")    # doctest: +SKIP
    """
    before, after = convention(source), convention(target)
    turn = to_number("turn", turn)
    _, rgb = load_light(environment, before.layout.aspect)
    if height is None:
        quarter = round(rgb.shape[0] / before.layout.rows)
        same = before.layout.rows == after.layout.rows
        height = rgb.shape[0] if same else max(2, int(quarter * after.layout.rows))
    height = to_whole_number("height", height, least=2)
    if height > LARGEST:
        raise BrdfkitError(f"height = {height} is more than a map may have, {LARGEST} rows.")
    if isinstance(after.layout, Cube) and height % after.layout.lines:
        raise BrdfkitError(
            f"height = {height} should be a multiple of {after.layout.lines}, the faces from top "
            f"to bottom of {target}."
        )
    return write(resample(rgb, before, after, height, turn, mirror), path)
