"""Reads pictures by Mitsuba, whatever their format: their pixels in linear sRGB."""

from pathlib import Path

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import is_utf8, require_file
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.mitsuba_bridge.properties.radiance_rows import require_rows

OURS = "BrdfkitError: "


def load_by_mitsuba(function, source, name):
    """The object that a `function` of Mitsuba's, such as `load_dict`, makes of `source`.

    Raises `BrdfkitError`, which names it `name`, where Mitsuba cannot; a sentence of a plugin of
    ours stands for itself.
    """
    if isinstance(source, str) and not is_utf8(source):
        raise BrdfkitError(f"{name}: its path is no UTF-8, as Mitsuba needs it; rename the file.")
    try:
        with use_two_threads():
            return function(source, parallel=False)
    except (MemoryError, IndexError, OverflowError) as error:  # of a size that no file has
        raise BrdfkitError(
            f"{name}: Mitsuba cannot load it: it states a size for which there is no memory."
        ) from error
    except BrdfkitError:
        raise
    except (RuntimeError, TypeError, ValueError) as error:
        said = str(error)
        if isinstance(error, UnicodeDecodeError):  # a damaged file's bytes are in the message
            said = error.object.decode(errors="replace")
        if "KeyboardInterrupt" in said:  # Ctrl-C in a plugin that is written in Python
            raise KeyboardInterrupt from None
        lines = [line.strip() for line in said.splitlines() if line.strip()]
        # a plugin written in Python reports its whole traceback: people need its last line only
        reason = lines[-1] if any("Traceback" in line for line in lines) else " ".join(lines)
        if OURS in reason:
            reason = reason.partition(OURS)[2]
            raise BrdfkitError(f"{name}: {reason.removeprefix(f'{name}: ')}") from error
        raise BrdfkitError(f"{name}: Mitsuba cannot load it ({reason.rstrip('.')}).") from error


LINEAR = ".exr", ".hdr", ".pfm", ".rgbe"  # files without a curve for screens


def read_photograph(path, accept_8_bit):
    """The linear pixels (height, width, 3) of a photograph.

    Raises `BrdfkitError` where there is none, for a file that Mitsuba cannot read, and for one of 8
    bits, unless `accept_8_bit`: then sRGB's curve is inverted.
    """
    if Path(path).suffix.lower() not in LINEAR and not accept_8_bit:
        raise BrdfkitError(
            f"{path}: such files hold 8 bits, or 16, behind a curve for screens; give an OpenEXR "
            "file, or give accept_8_bit=True (--accept-8-bit) to invert sRGB's curve."
        )
    return read_pixels(require_file(path), str(path))


def read_pixels(path, name):
    """The pixels (height, width, 3) of the picture in a file, which errors call `name`.

    Raises `BrdfkitError` for a file that Mitsuba cannot read, because it is cut off, for instance.
    """
    import mitsuba as mi

    if Path(path).is_file():
        require_rows(path, name)
    return load_by_mitsuba(lambda file, parallel: to_pixels(mi.Bitmap(file)), str(path), name)


def to_pixels(bitmap):
    """The pixels (height, width, 3) of a `mitsuba.Bitmap`."""
    import mitsuba as mi

    kind = mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32
    return np.array(bitmap.convert(*kind, srgb_gamma=False))
