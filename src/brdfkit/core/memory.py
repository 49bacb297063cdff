"""Checks, before a rendering starts, that its pictures fit into the available memory."""

import psutil

from brdfkit.core.errors import BrdfkitError

# The most memory that a rendering takes [bytes per pixel], measured at 2 to 9 million pixels:
# BYTES_OF_ONE for one picture, and BYTES_OF_SEVERAL + n BYTES_OF_EACH for n pictures, most of it to
# compare their colours
BYTES_OF_ONE = 220
BYTES_OF_SEVERAL, BYTES_OF_EACH = 330, 75


def require_memory(size: tuple[int, int], pictures: int, where: object = "") -> None:
    """Raise `BrdfkitError` where a rendering would need more memory than is available.

    `size` is (width, height) [pixels], `pictures` their number, `where` the file of the scene.

    >>> require_memory((100_000, 100_000), 1)
    Traceback (most recent call last):
    brdfkit.core.errors.BrdfkitError: A picture of 100000×100000 pixels would take about 2,200 ...
    """
    width, height = map(int, size)
    needed = (
        width
        * height
        * (BYTES_OF_ONE if pictures == 1 else BYTES_OF_SEVERAL + BYTES_OF_EACH * pictures)
    )
    available = psutil.virtual_memory().available
    if needed <= available:
        return
    what = "a picture" if pictures == 1 else f"{pictures} pictures"
    sentence = (
        f"{what} of {width}×{height} pixels would take about {_to_gigabytes(needed)} GB of memory, "
        f"of which {_to_gigabytes(available)} GB are available; give a smaller size."
    )
    raise BrdfkitError(f"{where}: {sentence}" if where else sentence[0].upper() + sentence[1:])


def require_bytes(needed: int, what: str) -> None:
    """Raise `BrdfkitError` where `what` needs more memory than is available.

    >>> require_bytes(10**15, "light.exr")
    Traceback (most recent call last):
    brdfkit.core.errors.BrdfkitError: light.exr would take 1,000,000 GB of memory, of which ...
    """
    available = psutil.virtual_memory().available
    if needed > available:
        raise BrdfkitError(
            f"{what} would take {_to_gigabytes(needed)} GB of memory, of which "
            f"{_to_gigabytes(available)} GB are available; make them smaller."
        )


def _to_gigabytes(size: float) -> str:
    """Format a number of bytes in gigabytes."""
    return f"{size / 1e9:,.0f}" if size >= 1e10 else f"{size / 1e9:.2g}"
