"""Encodes pictures as `data:` addresses, which HTML pages contain, and maps numbers to colours."""

import io
from base64 import b64encode
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike
from brdfkit.core.colours import to_srgb


def encode_jpeg(linear: AnyArray) -> str:
    """Return a picture (height, width, 3) of linear sRGB as the `data:` address of a JPEG."""
    return _encode_as_address(_convert_to_bytes(to_srgb(linear)), "JPEG", quality=92, subsampling=0)


def encode_webp(colours: AnyArray, **options: Any) -> str:
    """Return colours (height, width, 3) in 0..1 as the `data:` address of a WebP.

    It is half as long as a JPEG. `options` are those of Pillow, such as `quality` or `lossless`.
    """
    return _encode_as_address(_convert_to_bytes(colours), "WEBP", **options)


def halve_picture(linear: AnyArray) -> AnyArray:
    """Average blocks of 2×2 pixels of a picture (height, width, n)."""
    height, width = (n // 2 for n in linear.shape[:2])
    return linear[: 2 * height, : 2 * width].reshape(height, 2, width, 2, -1).mean(axis=(1, 3))


def shrink_picture(picture: AnyArray, longest: int) -> AnyArray:
    """Halve a picture (height, width, n) until no side is longer than `longest` pixels."""
    while max(picture.shape[:2]) > longest:
        picture = halve_picture(picture)
    return picture


def encode_png(colours: AnyArray) -> str:
    """Return colours (height, width, 3 or 4) in 0..1 as the `data:` address of a PNG."""
    return _encode_as_address(_convert_to_bytes(colours), "PNG", optimize=True)


def apply_colour_map(name: str, shares: ArrayLike) -> AnyArray:
    """Return the colours (..., 4) of matplotlib's colour map `name` for numbers (...) in 0..1."""
    import matplotlib as mpl

    return mpl.colormaps[name](np.clip(shares, 0, 1))


def draw_colour_bar(name: str, steps: int = 128) -> str:
    """Return the `data:` address of a picture, one pixel high, of a colour map from low to high."""
    return encode_png(apply_colour_map(name, np.linspace(0, 1, steps))[None, :, :3])


def _convert_to_bytes(shares: AnyArray) -> AnyArray:
    """Convert numbers in 0..1 to bytes; nan becomes 0."""
    return (np.clip(np.nan_to_num(shares), 0, 1) * 255 + 0.5).astype(np.uint8)


def _encode_as_address(pixels: AnyArray, kind: str, **options: Any) -> str:
    """Return the `data:` address of pixels (height, width, channels) in a format of Pillow."""
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, kind, **options)
    return f"data:image/{kind.lower()};base64,{b64encode(stream.getvalue()).decode()}"
