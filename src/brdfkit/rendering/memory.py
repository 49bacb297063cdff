"""Whether pictures fit into the machine's memory: asked before any of it is taken."""

import psutil

from brdfkit.errors import BrdfkitError

# Peaks of the resident memory [bytes per pixel] as measured from 2 to 9 million pixels: of one
# picture, and of several, whose differences in colour take most
ONE = 125
SEVERAL, EACH = 330, 75


def require_memory(size, pictures, where=""):
    """Raise `BrdfkitError` where the rendering is larger than the memory that is available.

    `size`: (width, height) [pixels]; `pictures`: how many of them; `where`: a scene's file.

    >>> require_memory((100_000, 100_000), 1)
    Traceback (most recent call last):
    brdfkit.errors.BrdfkitError: A picture of 100000×100000 pixels would take about 1,250 ...
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
