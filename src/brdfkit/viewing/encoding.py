"""Encodes pictures as bytes for the page: JPEG while something moves, PNG where nothing is lost."""

import io

import numpy as np
from PIL import Image

from brdfkit.core.array_types import AnyArray
from brdfkit.core.colours import to_srgb

QUALITY = 85  # of a JPEG
LEVELS = 4096  # of brightness, that `to_bytes_quickly` distinguishes


def to_bytes(linear: AnyArray) -> AnyArray:
    """Convert linear brightness, 0 to 1, to sRGB in 8 bits; nan becomes 0."""
    return (255 * to_srgb(np.nan_to_num(linear)) + 0.5).astype(np.uint8)


def to_bytes_quickly(linear: AnyArray) -> AnyArray:
    """Convert linear brightness, 0 to 1, to sRGB in 8 bits by a table, at most one level off."""
    codes = np.fmax(linear, 0) * (LEVELS - 1) + 0.5  # the number, also of nan and 0
    return SRGB_LEVELS.take(codes.astype(np.intp))


def encode_jpeg(colours: AnyArray) -> bytes:
    """Return a picture (height, width, 3), sRGB in 8 bits, as a JPEG."""
    return _encode(colours, "JPEG", quality=QUALITY)


def encode_png(colours: AnyArray) -> bytes:
    """Return a picture (height, width) or (height, width, 3), in 8 bits, as a PNG."""
    return _encode(colours, "PNG", compress_level=3)


def _encode(colours: AnyArray, kind: str, **options: int) -> bytes:
    """Return a picture in a format of Pillow's."""
    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(colours)).save(stream, kind, **options)
    return stream.getvalue()


SRGB_LEVELS = to_bytes(np.linspace(0, 1, LEVELS))
