"""Reading and writing environment maps: OpenEXR and other picture files, and the shipped maps."""

import warnings
from pathlib import Path

import numpy as np

from brdfkit.core import catalogue
from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError, find_nearest_name
from brdfkit.core.files import write_safely
from brdfkit.core.jit.threads import in_turn, use_two_threads
from brdfkit.core.locate import find_file_or_name
from brdfkit.mitsuba_bridge.properties.picture_file import read_pixels
from brdfkit.model import labels

HDR = ".exr", ".hdr", ".rgbe", ".pfm"
EIGHT_BIT = ".png", ".jpg", ".jpeg", ".bmp", ".tga"
EIGHT_BIT_WARNING = (
    "8 bits per channel: nothing is brighter than white, so that lamps and the sun are far too "
    "dark; look for the .exr or .hdr of the picture"
)
LATLONG = 2.0  # ratio of width to height of a map by latitude and longitude
LARGEST_HALF_FLOAT = 65_504.0


def find_map(name: str | Path) -> Path:
    """Return the path of an environment map, from its path or the name of a shipped map.

    Raises `BrdfkitError` if there is no such map.

    >>> find_map("studio").name
    'studio.exr'
    """
    place = find_file_or_name(name, "environment map", catalogue.list_environments())
    return catalogue.find_environment_file(place) if isinstance(place, str) else place


def looks_like_map(name: str) -> bool:
    """Return whether an argument of the command line, such as a path, means an environment map.

    It does if it has the suffix of a picture file, or is the name of a shipped map. The name may be
    misspelt, unless it resembles the name of a material as well.
    """
    if Path(name).suffix or "/" in name or Path(name).exists():
        return Path(name).suffix.lower() in HDR + EIGHT_BIT
    materials = [*labels.models(), *catalogue.list_materials()]
    maps = catalogue.list_environments()
    return bool(find_nearest_name(name, maps)) and not find_nearest_name(name, materials)


def load_map(source: str | Path | AnyArray) -> tuple[str, AnyArray]:
    """Return the name and the pixels (height, width, 3) of an environment map.

    `source` is a path, the name of a shipped map, or an array of pixels. Raises `BrdfkitError` if
    there is no such map, or if it has the wrong shape or fewer than 2×2 pixels.
    """
    if isinstance(source, np.ndarray):
        name, rgb = "the map", source
        if rgb.ndim != 3 or rgb.shape[2] != 3:
            raise BrdfkitError(
                f"the map has the shape {rgb.shape}; it should be (height, width, 3)."
            )
    else:
        name, rgb = str(source), read_map(find_map(source))
    if min(rgb.shape[:2]) < 2:
        size = "×".join(map(str, rgb.shape[1::-1]))
        raise BrdfkitError(f"{name}: the map has {size} pixels; it needs 2×2 or more.")
    return name, rgb


def load_radiance(source: str | Path | AnyArray, aspect: float = LATLONG) -> tuple[str, AnyArray]:
    """Return the name and the pixels of a map like `load_map`, but only if it can light a scene.

    Raises `BrdfkitError` if the ratio of columns to rows differs from `aspect` by more than 5 %, or
    if a value is negative or not finite. Warns if the file has 8 bits per channel.
    """
    name, rgb = load_map(source)
    height, width = rgb.shape[:2]
    if abs(width / height / aspect - 1) > 0.05:
        raise BrdfkitError(
            f"{name}: the map has {width}×{height} pixels, but its layout {aspect:.3g} times as "
            "many columns as rows; convert it by 'brdfkit convert --source LAYOUT'."
        )
    if not (np.isfinite(rgb).all() and rgb.min() >= 0):
        raise BrdfkitError(f"{name}: the map has a value that is negative or not finite.")
    if is_eight_bit(source):
        warnings.warn(f"{name} has {EIGHT_BIT_WARNING}.", stacklevel=2)
    return name, rgb


def is_eight_bit(source: str | Path | AnyArray) -> bool:
    """Return whether a map is a file whose suffix means 8 bits per channel, such as .png."""
    return isinstance(source, str | Path) and Path(source).suffix.lower() in EIGHT_BIT


@in_turn
def read_map(path: str | Path) -> AnyArray:
    """Read a map (height, width, 3) in linear sRGB from a file, by Mitsuba.

    Raises `BrdfkitError` if Mitsuba cannot read the file, for instance because it is truncated.
    """
    try:
        return read_pixels(path, path)
    except BrdfkitError as error:
        reason = str(error).removesuffix(".")
        raise BrdfkitError(f"{reason}: save or fetch it again, since it may be cut off.") from error


@in_turn
def write_map(rgb: AnyArray, path: str | Path) -> Path:
    """Write a map (height, width, 3) as OpenEXR, in half floats unless a value is too large.

    Returns the `Path`. Raises `BrdfkitError` for any suffix other than .exr.
    """
    import OpenEXR

    path = Path(path)
    if path.suffix.lower() != ".exr":
        raise BrdfkitError(f"{path}: maps are written as .exr; choose that suffix.")
    precision = np.float16 if rgb.max() <= LARGEST_HALF_FLOAT else np.float32
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.PIZ_COMPRESSION}
    channels = {c: np.ascontiguousarray(rgb[..., i], precision) for i, c in enumerate("RGB")}
    with write_safely(path) as beside, use_two_threads():
        OpenEXR.File(header, channels).write(str(beside))
    return path
