"""Loads objects by Mitsuba with brdfkit's errors, and pictures as pixels in linear sRGB."""

import re
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import is_utf8_path, require_file
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.mitsuba_bridge.properties.radiance_rows import require_intact_rows

OWN_ERROR = "BrdfkitError: "  # marks an error of brdfkit's plugins in a message of Mitsuba

# Where in its own code, and in its description of a single mesh, Mitsuba met an error
PLACE = re.compile(
    r'\[\w+\.(?:cpp|h):\d+\] (?:"[^"]*": )?|At dictionary node "root": '
    r'|\[\w+\] (?=Error while loading)|failed to instantiate shape plugin of type "(?:obj|ply)": '
    r'|Error while loading \w+ file "[^"]*": '
)

# What Mitsuba says of a file that ends too early
CUT_SHORT = re.compile(r"I/O error while attempting to read|read \d+ out of \d+ bytes")


def load_by_mitsuba(function: Callable[..., Any], source: Any, name: object) -> Any:
    """Load an object from `source` by a function of Mitsuba, such as `load_dict`.

    Raises `BrdfkitError`, which calls the object `name`, where Mitsuba cannot load it. The message
    of one of brdfkit's own plugins is kept.
    """
    if isinstance(source, str) and not is_utf8_path(source):
        raise BrdfkitError(f"{name}: its path is no UTF-8, as Mitsuba needs it; rename the file.")
    try:
        with use_two_threads():
            return function(source, parallel=False)
    except (MemoryError, IndexError, OverflowError) as error:  # a damaged file states a huge size
        raise BrdfkitError(
            f"{name}: Mitsuba cannot load it: it states a size for which there is no memory."
        ) from error
    except BrdfkitError:
        raise
    except (RuntimeError, TypeError, ValueError) as error:
        message = str(error)
        if isinstance(error, UnicodeDecodeError):  # the message contains bytes of a damaged file
            message = error.object.decode(errors="replace")
        if "KeyboardInterrupt" in message:  # Ctrl-C in a plugin that is written in Python
            raise KeyboardInterrupt from None
        lines = [line.strip() for line in message.splitlines() if line.strip()]
        # A plugin in Python reports its whole traceback, of which people need the last line only
        reason = lines[-1] if any("Traceback" in line for line in lines) else " ".join(lines)
        if OWN_ERROR in reason:
            reason = reason.partition(OWN_ERROR)[2]
            raise BrdfkitError(f"{name}: {reason.removeprefix(f'{name}: ')}") from error
        if CUT_SHORT.search(reason):
            raise BrdfkitError(f"{name}: it is damaged.") from error
        reason = PLACE.sub("", reason).rstrip(".!")
        raise BrdfkitError(f"{name}: Mitsuba cannot load it ({reason}).") from error


LINEAR = ".exr", ".hdr", ".pfm", ".rgbe"  # formats of linear values, without the curve of sRGB


def read_photograph(path: str | PathLike[str], accept_8_bit: bool) -> AnyArray:
    """Read the linear pixels (height, width, 3) of a photograph.

    Raises `BrdfkitError` for a missing file, for a file that Mitsuba cannot read, and for a file of
    8 bits unless `accept_8_bit` is set: then the curve of sRGB is inverted.
    """
    if Path(path).suffix.lower() not in LINEAR and not accept_8_bit:
        raise BrdfkitError(
            f"{path}: such files hold 8 bits, or 16, behind a curve for screens; give an OpenEXR "
            "file, or give accept_8_bit=True (--accept-8-bit) to invert sRGB's curve."
        )
    return read_pixels(require_file(path), str(path))


def read_pixels(path: str | PathLike[str], name: object) -> AnyArray:
    """Read the pixels (height, width, 3) of the picture in a file, which errors call `name`.

    Raises `BrdfkitError` for a file that Mitsuba cannot read, for instance because it is cut off.
    """
    import mitsuba as mi

    if Path(path).is_file():
        require_intact_rows(path, name)
    return load_by_mitsuba(lambda file, parallel: to_pixels(mi.Bitmap(file)), str(path), name)


def to_pixels(bitmap: MitsubaObject) -> AnyArray:
    """Convert a `mitsuba.Bitmap` to pixels (height, width, 3) in linear sRGB."""
    import mitsuba as mi

    kind = mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32
    return np.array(bitmap.convert(*kind, srgb_gamma=False))
