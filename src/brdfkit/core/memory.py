"""Checks, before a rendering starts, that its pictures fit into the available memory."""

import psutil

from brdfkit.core.errors import BrdfkitError

# Peak of the resident memory [bytes per pixel], measured from 2 to 9 million pixels: ONE for a
# single picture and its noise, SEVERAL + EACH·pictures for more, whose colour differences take most
ONE = 220
SEVERAL, EACH = 330, 75


def require_memory(size, pictures, where=""):
    """Raise `BrdfkitError` where a rendering would need more memory than is available.

    `size`: (width, height) [pixels]; `pictures`: their number; `where`: a scene's file, if any.

    >>> require_memory((100_000, 100_000), 1)
    Traceback (most recent call last):
    brdfkit.core.errors.BrdfkitError: A picture of 100000×100000 pixels would take about 2,200 ...
    """
    width, height = map(int, size)
    needed = width * height * (ONE if pictures == 1 else SEVERAL + EACH * pictures)
    available = psutil.virtual_memory().available
    if needed <= available:
        return
    what = "a picture" if pictures == 1 else f"{pictures} pictures"
    sentence = (
        f"{what} of {width}×{height} pixels would take about {_gigabytes(needed)} GB of memory, of "
        f"which {_gigabytes(available)} GB are available; give a smaller size."
    )
    raise BrdfkitError(f"{where}: {sentence}" if where else sentence[0].upper() + sentence[1:])


def _gigabytes(size):
    return f"{size / 1e9:,.0f}" if size >= 1e10 else f"{size / 1e9:.2g}"
