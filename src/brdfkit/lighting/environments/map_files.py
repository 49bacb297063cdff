"""Files of environment maps: OpenEXR and Radiance, or a name of a map that comes with brdfkit."""

import warnings
from pathlib import Path

import numpy as np

from brdfkit.core import catalogue
from brdfkit.core.errors import BrdfkitError, nearest
from brdfkit.core.files import write_safely
from brdfkit.core.jit.threads import in_turn, two_threads
from brdfkit.core.locate import find_file_or_name
from brdfkit.mitsuba_bridge.properties.picture_file import read_pixels
from brdfkit.model import labels

HDR = ".exr", ".hdr", ".rgbe", ".pfm"
EIGHT_BIT = ".png", ".jpg", ".jpeg", ".bmp", ".tga"
EIGHT_BIT_TOLD = (
    "8 bits per channel: nothing is brighter than white, so that lamps and the sun are far too "
    "dark; look for the .exr or .hdr of the picture"
)
LATLONG = 2.0  # columns over rows of a map by latitude and longitude
HALF = 65_504.0  # the largest half float


def find(name):
    """The `Path` of an environment map, given as a path or by the name of a shipped one.

    Raises `BrdfkitError` where there is neither.

    >>> find("studio").name
    'studio.exr'
    """
    place = find_file_or_name(name, "environment map", catalogue.environments())
    return catalogue.environment_path(place) if isinstance(place, str) else place


def looks_like_map(name):
    """Whether a word of the command line means an environment map: by its suffix, or its name,
    which may be misspelt where it is like no material's."""
    if Path(name).suffix or "/" in name or Path(name).exists():
        return Path(name).suffix.lower() in HDR + EIGHT_BIT
    materials = [*labels.models(), *catalogue.materials()]
    return bool(nearest(name, catalogue.environments())) and not nearest(name, materials)


def load(given):
    """The name and the pixels (height, width, 3) of a map: a path, a shipped name, or an array.

    Raises `BrdfkitError` for what is none of these, and for a map of fewer than 2×2 pixels.
    """
    if isinstance(given, np.ndarray):
        name, rgb = "the map", given
        if rgb.ndim != 3 or rgb.shape[2] != 3:
            raise BrdfkitError(
                f"the map has the shape {rgb.shape}; it should be (height, width, 3)."
            )
    else:
        name, rgb = str(given), read(find(given))
    if min(rgb.shape[:2]) < 2:
        size = "×".join(map(str, rgb.shape[1::-1]))
        raise BrdfkitError(f"{name}: the map has {size} pixels; it needs 2×2 or more.")
    return name, rgb


def load_light(given, aspect=LATLONG):
    """`load`, of a map from which light is computed; `aspect`: its columns over its rows.

    Raises `BrdfkitError` also for another shape, by more than 5 %, and for a value that is negative
    or not finite. Warns of 8 bits per channel.
    """
    name, rgb = load(given)
    height, width = rgb.shape[:2]
    if abs(width / height / aspect - 1) > 0.05:
        raise BrdfkitError(
            f"{name}: the map has {width}×{height} pixels, and its layout {aspect:.3g} times as "
            "many columns as rows; name its layout to 'brdfkit convert --from'."
        )
    if not (np.isfinite(rgb).all() and rgb.min() >= 0):
        raise BrdfkitError(f"{name}: the map has a negative value, or one not finite; mend it.")
    if is_eight_bit(given):
        warnings.warn(f"{name} has {EIGHT_BIT_TOLD}.", stacklevel=2)
    return name, rgb


def is_eight_bit(given):
    """Whether a map, a path or a name, is in a file with 8 bits per channel."""
    return isinstance(given, str | Path) and Path(given).suffix.lower() in EIGHT_BIT


@in_turn
def read(path):
    """The map (height, width, 3) in linear sRGB of a file that Mitsuba reads.

    Raises `BrdfkitError` for a file that it cannot read, because it is cut off, for instance.
    """
    try:
        return read_pixels(path, path)
    except BrdfkitError as error:
        reason = str(error).removesuffix(".")
        raise BrdfkitError(f"{reason}: fetch it again if it is cut off, or another.") from error


@in_turn
def write(rgb, path):
    """Write a map (height, width, 3) as OpenEXR, in half floats where they reach.

    Returns the `Path`. Raises `BrdfkitError` for another suffix than .exr.
    """
    import OpenEXR

    path = Path(path)
    if path.suffix.lower() != ".exr":
        raise BrdfkitError(f"{path}: maps are written as .exr; choose that suffix.")
    precision = np.float16 if rgb.max() <= HALF else np.float32
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.PIZ_COMPRESSION}
    channels = {c: np.ascontiguousarray(rgb[..., i], precision) for i, c in enumerate("RGB")}
    with write_safely(path) as beside, two_threads():
        OpenEXR.File(header, channels).write(str(beside))
    return path
