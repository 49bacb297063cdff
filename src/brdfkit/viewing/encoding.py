"""Encodes pictures as bytes for the page: JPEG while something moves, PNG where nothing is lost."""

import io

import numpy as np
from PIL import Image

from brdfkit.core.array_types import AnyArray

QUALITY = 85  # of a JPEG


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
